// A table that grows row by row and is readable at any moment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace kluft {

/// What a table held at some time: enough to find that place in it again, and to see that nothing before it was changed.
struct TableMark {
    std::uint64_t bytes = 0;
    std::string digest; ///< of the lines

    bool operator==(const TableMark&) const = default;
};

/// A CSV file whose first line is `header`. Each row reaches the file in one write, so that a run that is killed leaves
/// whole rows; a row that does not fit on the disk is taken back.
class AppendTable {
public:
    /// A new table with no rows; replaces an old file. Throws ResourceError.
    [[nodiscard]] static AppendTable create(const std::filesystem::path& path, std::string_view header);

    /// Goes on with an old table from where `mark` was made of it; later rows are cut off. Throws InputError when the
    /// file is missing, has another header, is shorter than it was or was changed; ResourceError when it cannot be written.
    [[nodiscard]] static AppendTable resume(const std::filesystem::path& path, std::string_view header,
                                            const TableMark& mark);

    AppendTable(AppendTable&&) noexcept;
    AppendTable& operator=(AppendTable&&) noexcept;
    ~AppendTable();

    /// Adds a row (without the end of the line). Throws ResourceError; the table then ends with the row before.
    void append(std::string_view row);

    /// Brings all rows to the disk. Throws ResourceError.
    void sync();

    [[nodiscard]] TableMark mark() const;

private:
    struct File;
    explicit AppendTable(std::unique_ptr<File> file);
    std::unique_ptr<File> file_;
};

} // namespace kluft
