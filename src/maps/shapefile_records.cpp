#include "shapefile_records.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t header_length = 100;      ///< bytes, of .shp and .shx
constexpr std::int64_t index_entry_length = 8;   ///< bytes
constexpr std::int64_t record_header_length = 8; ///< bytes
constexpr std::int64_t bytes_per_word = 2;
constexpr std::int64_t length_in_header = 24; ///< bytes from the beginning of a .shp, of its length in words
constexpr std::int64_t count_in_table = 4;    ///< bytes from the beginning of a .dbf

using FourBytes = std::array<unsigned char, 4>;

FourBytes bytes_at(std::ifstream& file, std::int64_t position) {
    FourBytes bytes{};
    std::array<char, 4> read{};
    file.seekg(position);
    file.read(read.data(), read.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(read[i]);
    return bytes;
}

std::int64_t big_endian(const FourBytes& b) { return (std::int64_t{b[0]} << 24) | (b[1] << 16) | (b[2] << 8) | b[3]; }
std::int64_t little_endian(const FourBytes& b) { return big_endian({b[3], b[2], b[1], b[0]}); }

std::int64_t length_of(const fs::path& file) {
    std::error_code error;
    return static_cast<std::int64_t>(fs::file_size(file, error));
}

/// The highest number of a record; shapes that were made longer have left their old ones behind, with the same numbers.
std::int64_t last_record_of(const fs::path& file) {
    std::ifstream shapes(file, std::ios::binary);
    const std::int64_t length =
        std::min(length_of(file), bytes_per_word * big_endian(bytes_at(shapes, length_in_header)));
    std::int64_t last = 0;
    for (std::int64_t at = header_length; at + record_header_length <= length && shapes;) {
        last = std::max(last, big_endian(bytes_at(shapes, at)));
        at += record_header_length + bytes_per_word * big_endian(bytes_at(shapes, at + 4));
    }
    return last;
}

} // namespace

void require_equal_records(const fs::path& shapes, const fs::path& index, const fs::path& attributes) {
    const std::int64_t of_shapes = last_record_of(shapes);
    const std::int64_t of_index = (length_of(index) - header_length) / index_entry_length;
    std::ifstream table(attributes, std::ios::binary);
    const std::int64_t of_attributes = little_endian(bytes_at(table, count_in_table));
    if (of_shapes <= of_index && of_index == of_attributes) return;
    throw InputError(fmt::format(
        "{}: expected as many shapes as {} and {} have records, found {}, {} and {}; one of the files is of "
        "another state of the map, which is to be saved anew",
        shapes.string(), index.filename().string(), attributes.filename().string(), of_shapes, of_index,
        of_attributes));
}

} // namespace kluft
