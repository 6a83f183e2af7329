// How many records the three parts of a shapefile hold (ESRI Shapefile Technical Description, 1998; dBASE III table).
#pragma once

#include <filesystem>

namespace kluft {

/// Throws InputError, naming the file, unless index and attributes have as many records, and no shape a higher number. `index` and `attributes`: the files
/// .shx and .dbf beside `shapes`.
void require_equal_records(const std::filesystem::path& shapes, const std::filesystem::path& index,
                           const std::filesystem::path& attributes);

} // namespace kluft
