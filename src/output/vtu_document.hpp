// A VTK XML unstructured grid whose arrays stand compressed (zlib) behind the XML.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// The arrays are written one after the other, each number as it is known and compressed piece by piece, so that the
/// compressed document is all that is kept. Throws std::bad_alloc.
class VtuDocument {
public:
    /// The array being written, until the next one begins.
    class Array {
    public:
        /// Numbers of the type that the array was begun with. What is not finite becomes zero, and is counted.
        void put(double number);
        void put(std::int64_t number) { append(&number, sizeof number); }
        void put(std::int32_t number) { append(&number, sizeof number); }
        void put(std::uint8_t number) { append(&number, sizeof number); }
        /// As (x, y, 0).
        void put(const Vec2& vector);
        /// As 3 x 3 numbers: the plane's, `across` it on the diagonal, the rest zero.
        void put(const Mat2& tensor, double across);

    private:
        friend VtuDocument;
        explicit Array(VtuDocument& document) : document_(document) {}
        void append(const void* bytes, std::size_t size) { document_.append(bytes, size); }

        VtuDocument& document_;
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
    [[nodiscard]] Array cell_vectors(std::string_view name);

    /// Field data. A text is a name: other readers than VTK's know no arrays of texts.
    void add_field(std::string_view name, double value);
    void add_field(std::string_view name, std::int32_t value);

    /// The file's content, which leaves the document without its arrays. Ends the field data with the number of
    /// replaced values.
    [[nodiscard]] std::string content();

private:
    Array begin(std::string& section, std::string_view attributes);
    Array cell_field(std::string_view name, std::string_view type);
    [[nodiscard]] double finite(double number);
    void append(const void* bytes, std::size_t size);
    void compress_piece();
    void end_array();

    std::size_t n_points_;
    std::size_t n_cells_;
    std::int32_t n_replaced_ = 0;
    std::string field_data_, points_, cells_, point_data_, cell_data_;
    std::string appended_;
    std::string piece_;                   ///< of the array being written, not compressed yet
    std::vector<std::uint64_t> n_bytes_;  ///< of its compressed pieces
    std::optional<std::size_t> array_at_; ///< where in appended_ it begins; none before the first one
};

} // namespace kluft
