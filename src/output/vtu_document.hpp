// A VTK XML unstructured grid whose arrays stand raw behind the XML.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kluft {

class VtuDocument {
public:
    VtuDocument(std::size_t n_points, std::size_t n_cells);

    void add_points(const std::vector<double>& xyz);
    /// Cells by the point indices of each and the end of each in that list; all of one VTK type.
    void add_cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                   std::uint8_t type);
    void add_point_vectors(std::string_view name, const std::vector<double>& xyz);
    void add_cell_field(std::string_view name, const std::vector<double>& values);
    void add_cell_field(std::string_view name, const std::vector<std::int32_t>& values);
    void add_field(std::string_view name, double value);
    void add_field(std::string_view name, std::int32_t value);
    void add_field(std::string_view name, const std::vector<std::string>& texts);

    /// The file's content, which leaves the document without its arrays. Ends the field data with the number of
    /// replaced values.
    [[nodiscard]] std::string content();

private:
    void add_array(std::string& section, std::string_view attributes, const void* bytes, std::size_t size);
    std::vector<double> finite(const std::vector<double>& values);

    std::size_t n_points_;
    std::size_t n_cells_;
    std::int32_t n_replaced_ = 0;
    std::string field_data_, points_, cells_, point_data_, cell_data_;
    std::string appended_;
};

} // namespace kluft
