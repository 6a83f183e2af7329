// The files of src/report/page and the plot library, which the build puts into the program.
#pragma once

#include <string_view>

namespace kluft {

/// Content of the file of that name; "" if there is none.
[[nodiscard]] std::string_view page_file(std::string_view name);

} // namespace kluft
