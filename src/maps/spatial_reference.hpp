// Coordinate systems as GDAL holds them.
#pragma once

#include <memory>
#include <string>

#include "gdal_library.hpp"

namespace kluft {

using SpatialReference = std::unique_ptr<void, decltype(&::OSRDestroySpatialReference)>;

/// An empty one.
[[nodiscard]] inline SpatialReference new_spatial_reference() {
    return {KLUFT_GDAL(OSRNewSpatialReference)(nullptr), KLUFT_GDAL(OSRDestroySpatialReference)};
}

/// "EPSG:25832", else WKT; empty for none and for one that says that it is not known.
[[nodiscard]] inline std::string crs_text(OGRSpatialReferenceH reference) {
    if (reference == nullptr) return {};
    const char* const name = KLUFT_GDAL(OSRGetName)(reference);
    if (name == nullptr || std::string(name).starts_with("Undefined") || std::string(name).starts_with("Unknown"))
        return {};
    const char* const authority = KLUFT_GDAL(OSRGetAuthorityName)(reference, nullptr);
    const char* const code = KLUFT_GDAL(OSRGetAuthorityCode)(reference, nullptr);
    if (authority != nullptr && code != nullptr) return std::string(authority) + ":" + code;
    char* wkt = nullptr;
    (void)KLUFT_GDAL(OSRExportToWkt)(reference, &wkt);
    std::string text = wkt == nullptr ? "" : wkt;
    KLUFT_GDAL(VSIFree)(wkt);
    return text;
}

} // namespace kluft
