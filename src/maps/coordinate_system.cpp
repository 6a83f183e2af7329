#include "kluft/maps/coordinate_system.hpp"

#include <algorithm>
#include <cctype>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "gdal_library.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/place_text.hpp"
#include "spatial_reference.hpp"

namespace kluft {

namespace {

using Transformation = std::unique_ptr<void, decltype(&::OCTDestroyCoordinateTransformation)>;

/// No name of a file and no address, which GDAL would open.
bool is_definition(const std::string& text) {
    const auto is_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; };
    if (text.find('[') != std::string::npos)
        return std::isupper(static_cast<unsigned char>(text.front())) != 0 && !text.starts_with("http");
    const auto colon = text.find(':');
    return colon != std::string::npos && colon > 0 && colon + 1 < text.size() &&
           std::ranges::all_of(text, [&](unsigned char c) { return c == ':' || is_word(c); });
}

[[noreturn]] void refuse_crs(const std::string& text, const GdalMessages& messages) {
    const std::string said = messages.text();
    if (said.find("proj.db") != std::string::npos)
        throw InputError(fmt::format(
            "coordinate system {}: expected the data of PROJ (Debian: proj-data), found none: {}", text, said));
    throw InputError(fmt::format("expected a coordinate system such as EPSG:25832, found '{}'{}", text,
                                 said.empty() ? said : " (" + said + ")"));
}

SpatialReference spatial_reference(const std::string& text) {
    const GdalMessages messages;
    SpatialReference reference = new_spatial_reference();
    const std::string definition = canonical_crs(text);
    if (!is_definition(definition) ||
        KLUFT_GDAL(OSRSetFromUserInput)(reference.get(), definition.c_str()) != OGRERR_NONE)
        refuse_crs(text, messages);
    KLUFT_GDAL(OSRStripVertical)(reference.get());
    KLUFT_GDAL(OSRSetAxisMappingStrategy)(reference.get(), OAMS_TRADITIONAL_GIS_ORDER);
    return reference;
}

/// The places of a feature, one after the other.
template <class Visit> void each_path(MapFeature& feature, Visit visit) {
    for (auto& line : feature.lines) visit(line);
    for (auto& polygon : feature.polygons)
        for (auto& ring : polygon) visit(ring);
}

void project_path(std::vector<Vec2>& path, const Transformation& transformation, long long feature,
                  const std::string& to) {
    std::vector<double> x, y;
    for (const Vec2& point : path) {
        x.push_back(point.x());
        y.push_back(point.y());
    }
    std::vector<int> is_good(path.size(), 0);
    (void)KLUFT_GDAL(OCTTransformEx)(transformation.get(), static_cast<int>(path.size()), x.data(), y.data(), nullptr,
                                     is_good.data());
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Vec2 projected(x[i], y[i]);
        if (is_good[i] == 0 || !projected.allFinite())
            throw InputError(fmt::format("feature {}: expected a place that can be projected to {}, found {}", feature,
                                         to, place_text(path[i])));
        path[i] = projected;
    }
}

} // namespace

CoordinateSystem describe_crs(const std::string& text) {
    const SpatialReference reference = spatial_reference(text);
    const GdalMessages messages;
    CoordinateSystem system;
    const char* const name = KLUFT_GDAL(OSRGetName)(reference.get());
    const std::string code = crs_text(reference.get());
    system.name = name == nullptr ? code : name;
    if (code.find('[') == std::string::npos && name != nullptr) system.name += fmt::format(" ({})", code);
    system.is_geographic = KLUFT_GDAL(OSRIsGeographic)(reference.get()) != 0;
    if (!system.is_geographic) system.unit = KLUFT_GDAL(OSRGetLinearUnits)(reference.get(), nullptr);
    return system;
}

void project(MapLayer& layer, const std::string& from, const std::string& to) {
    const SpatialReference source = spatial_reference(from);
    const SpatialReference target = spatial_reference(to);
    const GdalMessages messages;
    if (KLUFT_GDAL(OSRIsSame)(source.get(), target.get()) != 0) return;
    const Transformation transformation(KLUFT_GDAL(OCTNewCoordinateTransformation)(source.get(), target.get()),
                                        KLUFT_GDAL(OCTDestroyCoordinateTransformation));
    if (!transformation)
        throw InputError(fmt::format("no projection from {} to {} is known{}", from, to,
                                     messages.text().empty() ? "" : ": " + messages.text()));
    for (MapFeature& feature : layer.features)
        each_path(feature, [&](std::vector<Vec2>& path) { project_path(path, transformation, feature.id, to); });
}

} // namespace kluft
