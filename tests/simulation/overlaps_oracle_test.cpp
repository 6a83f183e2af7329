// Blocks of a body that has collapsed against GEOS, which intersects polygons by algorithms of its own.
#include <geos_c.h>

#include <algorithm>
#include <cstdarg>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/scene_run.hpp"
#include "support/source_folder.hpp"

namespace kluft {
namespace {

constexpr double negligible_overlap =
    0.02; ///< of the smaller block: corners that have gone a little into what they press on

class Polygons {
public:
    Polygons() : context_(GEOS_init_r()) {}
    ~Polygons() {
        for (GEOSGeometry* each : polygons_) GEOSGeom_destroy_r(context_, each);
        GEOS_finish_r(context_);
    }
    Polygons(const Polygons&) = delete;
    Polygons& operator=(const Polygons&) = delete;

    void add(std::vector<Vec2> corners) {
        corners.push_back(corners.front());
        GEOSCoordSequence* ring = GEOSCoordSeq_create_r(context_, static_cast<unsigned>(corners.size()), 2);
        for (unsigned i = 0; i < corners.size(); ++i)
            GEOSCoordSeq_setXY_r(context_, ring, i, corners[i].x(), corners[i].y());
        polygons_.push_back(
            GEOSGeom_createPolygon_r(context_, GEOSGeom_createLinearRing_r(context_, ring), nullptr, 0));
    }
    /// The area that both have over that of the smaller one.
    double overlap(int a, int b) {
        if (GEOSIntersects_r(context_, polygons_[a], polygons_[b]) != 1) return 0.0;
        GEOSGeometry* common = GEOSIntersection_r(context_, polygons_[a], polygons_[b]);
        const double share = area(common) / std::min(area(polygons_[a]), area(polygons_[b]));
        GEOSGeom_destroy_r(context_, common);
        return share;
    }
    [[nodiscard]] int size() const { return static_cast<int>(polygons_.size()); }

private:
    double area(const GEOSGeometry* of) {
        double result = 0.0;
        GEOSArea_r(context_, of, &result);
        return result;
    }

    GEOSContextHandle_t context_;
    std::vector<GEOSGeometry*> polygons_;
};

/// Pairs of blocks that overlap in a state and have no point where they meet, each with its share.
std::string overlaps_without_contact(const BlockSystem& system, const FieldRecord& fields) {
    Polygons blocks;
    std::size_t vertex = 0;
    for (const Block& block : system.blocks) {
        std::vector<Vec2> corners;
        for (const Edge& edge : block.edges)
            corners.push_back(edge_start(system, edge) + fields.displacement[vertex++]);
        blocks.add(corners);
    }
    std::set<std::pair<int, int>> meeting;
    for (const ContactForce& at : fields.contacts) meeting.insert(std::minmax(at.block_a, at.block_b));
    std::string found;
    for (int a = 0; a < blocks.size(); ++a) {
        for (int b = a + 1; b < blocks.size(); ++b) {
            if (meeting.contains({a, b})) continue;
            const double share = blocks.overlap(a, b);
            if (share > negligible_overlap)
                found += std::to_string(a) + "-" + std::to_string(b) + ": " + std::to_string(share) + "; ";
        }
    }
    return found;
}

class Collapsed : public testing::TestWithParam<std::pair<const char*, const char*>> {};

// Far behind their peaks, where wedges have been squeezed out and triangles rolled over, no two blocks are in each other with nothing
// between them. Corners that two blocks had as cut were never contacts before: with triangles of 0.035 and 0.03 m up to 12 and 61 %
// of a block lay in another one.
TEST_P(Collapsed, NoTwoBlocksOverlapWithoutAContact) {
    const auto& [spacing, strain] = GetParam();
    const SceneRun run =
        run_scene(read_scene(source_folder / "models/triaxial/case-3-all.yaml",
                             {std::string("geometry.tessellation.triangles.spacing=") + spacing,
                              "interfaces.crack.friction_angle=20", std::string("stages.1.strain.value=") + strain}));
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_GT(run.history.back().cracks_shear, 20);
    for (std::size_t step = 0; step < run.fields.size(); step += 8)
        EXPECT_EQ(overlaps_without_contact(run.model.system, run.fields[step]), "") << "load step " << step;
}

INSTANTIATE_TEST_SUITE_P(SlowTriangles, Collapsed,
                         testing::Values(std::pair("0.035 m", "3.5 %"), std::pair("0.03 m", "2 %")));

} // namespace
} // namespace kluft
