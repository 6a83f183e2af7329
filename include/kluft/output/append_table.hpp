// A table that grows row by row and is readable at any moment.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace kluft {

/// A CSV file whose first line is `header` and whose first column is the load step. Each row reaches the file in one
/// write, so that a run that is killed leaves whole rows; a row that does not fit on the disk is taken back.
class AppendTable {
public:
    /// A new table with no rows; replaces an old file. Throws ResourceError.
    [[nodiscard]] static AppendTable create(const std::filesystem::path& path, std::string_view header);

    /// Goes on with an old table after its rows with a load step above `last_step` are cut off.
    /// Throws InputError when the file is missing or has another header, ResourceError when it cannot be written.
    [[nodiscard]] static AppendTable resume(const std::filesystem::path& path, std::string_view header, int last_step);

    AppendTable(AppendTable&&) noexcept;
    AppendTable& operator=(AppendTable&&) noexcept;
    ~AppendTable();

    /// Adds a row (without the end of the line). Throws ResourceError; the table then ends with the row before.
    void append(std::string_view row);

    /// Brings all rows to the disk. Throws ResourceError.
    void sync();

private:
    struct File;
    explicit AppendTable(std::unique_ptr<File> file);
    std::unique_ptr<File> file_;
};

/// Cuts off the rows of a table with a load step (first column) above `last_step`, and an unfinished last line.
/// Throws InputError when the file is missing, its first line is not `header` or a row does not begin with a number.
void cut_table(const std::filesystem::path& path, std::string_view header, int last_step);

} // namespace kluft
