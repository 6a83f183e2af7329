#include "kluft/report/number_table.hpp"

#include <charconv>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
        cells.push_back(line.substr(0, comma));
        line.remove_prefix(comma + 1);
    }
    cells.push_back(line);
    return cells;
}

double number_in(std::string_view cell) {
    double number = 0.0;
    const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    const bool is_number = result.ec == std::errc() && result.ptr == cell.data() + cell.size();
    return is_number ? number : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

NumberTable read_number_table(const std::filesystem::path& path) {
    const std::string content = read_file(path);
    NumberTable table;
    std::string_view rest = content;
    int line_number = 0;
    for (std::size_t end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n')) {
        const auto cells = cells_of(rest.substr(0, end));
        rest.remove_prefix(end + 1);
        if (++line_number == 1) {
            table.names.assign(cells.begin(), cells.end());
            table.columns.resize(cells.size());
            continue;
        }
        if (cells.size() != table.names.size())
            throw InputError(fmt::format("{}:{}: expected {} cells, found {}", path.string(), line_number,
                                         table.names.size(), cells.size()));
        for (std::size_t i = 0; i < cells.size(); ++i) table.columns[i].push_back(number_in(cells[i]));
    }
    return table;
}

} // namespace kluft
