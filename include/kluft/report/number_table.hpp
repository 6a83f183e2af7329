// Tables of numbers, read without knowing their columns.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kluft {

struct NumberTable {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns; ///< one per name; NaN where a cell is no number

    /// Rows of all columns.
    [[nodiscard]] std::size_t n_rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Reads a table with commas. A last line without its end, which a killed run may leave, is ignored. Throws InputError where the
/// file cannot be read, or a line has another number of cells than the first one.
[[nodiscard]] NumberTable read_number_table(const std::filesystem::path& path);

} // namespace kluft
