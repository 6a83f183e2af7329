// A real map: 240 traces of an outcrop, near x = 466 000, y = 6 692 100, abutting to rounding only.
#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/scene/map_reader.hpp"

namespace kluft {
namespace {

using namespace cut_scenes;

GeometrySpec outcrop() {
    const std::filesystem::path folder = std::filesystem::path(KLUFT_SOURCE_DIR) / "models/data/outcrop-kb7";
    GeometrySpec spec;
    const MappedArea area = read_map_area({.file = folder / "area.geojson"});
    spec.domain = area.outline;
    spec.holes = area.holes;
    for (auto& trace : read_map_traces({.file = folder / "traces.geojson"}).traces)
        spec.fractures.push_back({trace.points, 0, ""});
    return spec;
}

TEST(Outcrop, HasTheTracesAndTheAreaOfItsDescription) {
    const GeometrySpec spec = outcrop();
    EXPECT_EQ(spec.fractures.size(), 240U);
    std::size_t n_segments = 0;
    for (const FractureTrace& trace : spec.fractures) n_segments += trace.points.size() - 1;
    EXPECT_EQ(n_segments, 1067U);
    EXPECT_NEAR(domain_area(spec), 534.684833972999970, 1e-5); // Shape_Area of the feature
}

TEST(Outcrop, IsCutByItsTracesAlone) {
    const GeometrySpec spec = outcrop();
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    // Without carrying ends on to what they miss by rounding there would be 13 blocks.
    EXPECT_GT(body.system.n_blocks(), 35);
    EXPECT_GT(body.report.joined_ends, 50);
    EXPECT_GT(body.report.pruned.size(), 100);
}

TEST(Outcrop, IsCutWithHexagons) {
    GeometrySpec spec = outcrop();
    spec.tessellation = Tessellation{{.spacing = 0.5}, 1, {}};
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    EXPECT_GT(body.system.n_blocks(), 2400);
    EXPECT_GE(body.report.smallest_area, 0.05 * hexagon_area(0.5));
}

} // namespace
} // namespace kluft
