// The library that reads and writes map files and knows coordinate systems. It is loaded when first needed.
#pragma once

#include <string>

namespace kluft {

/// Its version, "3.6.2"; empty in a build without it.
[[nodiscard]] std::string gdal_version();

/// What keeps GDAL from use: that the build is without it, or why it cannot be loaded. Empty where nothing does.
[[nodiscard]] std::string gdal_problem();

/// Throws InputError with that problem, after `what` and a colon where that is given; ResourceError where GDAL is there and the memory
/// to load it is not.
void require_gdal(const std::string& what = {});

} // namespace kluft
