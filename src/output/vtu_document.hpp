// A VTK XML unstructured grid whose arrays stand raw behind the XML.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// The arrays are written one after the other, each number as it is known, so that the document is all that is kept.
class VtuDocument {
public:
    /// The array being written; complete when it goes out of scope, and only then may the next one begin.
    class Array {
    public:
        ~Array();
        Array(const Array&) = delete;
        Array& operator=(const Array&) = delete;

        /// Numbers of the type that the array was begun with. What is not finite becomes zero, and is counted.
        void put(double number);
        void put(std::int64_t number) { append(&number, sizeof number); }
        void put(std::int32_t number) { append(&number, sizeof number); }
        void put(std::uint8_t number) { append(&number, sizeof number); }
        /// As (x, y, 0).
        void put(const Vec2& vector);
        /// As 3 x 3 numbers, those out of the plane zero.
        void put(const Mat2& tensor);

    private:
        friend VtuDocument;
        explicit Array(VtuDocument& document);
        void append(const void* bytes, std::size_t size);

        VtuDocument& document_;
        std::size_t begin_;
    };

    VtuDocument(std::size_t n_points, std::size_t n_cells);

    [[nodiscard]] Array points();
    [[nodiscard]] Array point_vectors(std::string_view name);
    /// Of the cells: the indices of their points (int64), where each ends in that list (int64), their VTK types (uint8).
    [[nodiscard]] Array connectivity();
    [[nodiscard]] Array ends();
    [[nodiscard]] Array types();

    /// A number per cell, double or int32: value(0), value(1), ...
    template <class Value> void add_cell_field(std::string_view name, Value value) {
        const bool real = std::is_same_v<decltype(value(std::size_t{})), double>;
        Array array = cell_field(name, real ? "Float64" : "Int32");
        for (std::size_t i = 0; i < n_cells_; ++i) array.put(value(i));
    }

    [[nodiscard]] Array cell_tensors(std::string_view name);

    void add_field(std::string_view name, double value);
    void add_field(std::string_view name, std::int32_t value);
    void add_field(std::string_view name, const std::vector<std::string>& texts);

    /// The file's content, which leaves the document without its arrays. Ends the field data with the number of
    /// replaced values.
    [[nodiscard]] std::string content();

private:
    Array begin(std::string& section, std::string_view attributes);
    Array cell_field(std::string_view name, std::string_view type);
    [[nodiscard]] double finite(double number);

    std::size_t n_points_;
    std::size_t n_cells_;
    std::int32_t n_replaced_ = 0;
    std::string field_data_, points_, cells_, point_data_, cell_data_;
    std::string appended_;
};

} // namespace kluft
