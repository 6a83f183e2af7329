#include "kluft/output/vtu.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "kluft/output/atomic_file.hpp"
#include "kluft/output/block_outline.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;

/// Reads a named array of a VTU file by the offset in its XML, as ParaView does: number of pieces, size of a piece and of a
/// smaller last one, compressed sizes, compressed pieces.
template <class Number> std::vector<Number> array_of(const std::string& file, const std::string& name) {
    const std::size_t appended = file.find("<AppendedData");
    const std::size_t named = file.find("Name=\"" + name + "\"");
    if (named >= appended) return {};
    const std::size_t offset = file.find("offset=\"", named) + std::strlen("offset=\"");
    std::size_t at = file.find("\n_", appended) + 2 + std::stoul(file.substr(offset, 20));
    const auto next = [&] {
        std::uint64_t number = 0;
        std::memcpy(&number, &file[at], sizeof number);
        at += sizeof number;
        return number;
    };
    const std::uint64_t n_pieces = next();
    const std::uint64_t piece = next();
    const std::uint64_t last = next();
    std::vector<std::uint64_t> sizes(n_pieces);
    for (auto& size : sizes) size = next();
    std::vector<Number> values;
    for (std::size_t i = 0; i < n_pieces; ++i) {
        uLongf size = i + 1 == n_pieces && last > 0 ? last : piece;
        std::vector<Number> part(size / sizeof(Number));
        EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(part.data()), &size, reinterpret_cast<const Bytef*>(&file[at]),
                             sizes[i]),
                  Z_OK);
        EXPECT_EQ(size, part.size() * sizeof(Number));
        values.insert(values.end(), part.begin(), part.end());
        at += sizes[i];
    }
    return values;
}

double area_of_cell(const std::vector<double>& points, const std::vector<std::int64_t>& connectivity,
                    std::int64_t begin, std::int64_t end) {
    double area = 0.0;
    for (std::int64_t i = begin; i < end; ++i) {
        const std::int64_t p = connectivity[i];
        const std::int64_t q = connectivity[i + 1 < end ? i + 1 : begin];
        area += 0.5 * (points[3 * p] * points[3 * q + 1] - points[3 * q] * points[3 * p + 1]);
    }
    return area;
}

TEST(Vtu, HoldsTheBlocksAsPolygonsOfTheirArea) {
    const BlockSystem system = testing::hexagon_grid(4, 3, 0.1, {2.0, 1.0});
    const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    const std::string file = blocks_vtu(system, fields, {{"sandstone"}, {}, {}}, StepRecord{});
    EXPECT_THAT(file, HasSubstr("NumberOfPoints=\"72\" NumberOfCells=\"12\""));
    EXPECT_THAT(file, HasSubstr("header_type=\"UInt64\""));
    EXPECT_THAT(file, HasSubstr("type=\"Float64\" Name=\"Points\""));
    const auto points = array_of<double>(file, "Points");
    const auto connectivity = array_of<std::int64_t>(file, "connectivity");
    const auto ends = array_of<std::int64_t>(file, "offsets");
    ASSERT_EQ(points.size(), 216U);
    ASSERT_EQ(ends.size(), 12U);
    EXPECT_EQ(array_of<std::uint8_t>(file, "types"), std::vector<std::uint8_t>(12, 7));
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_NEAR(area_of_cell(points, connectivity, i == 0 ? 0 : ends[i - 1], ends[i]), 0.01 * std::sqrt(0.75),
                    1e-14);
    // The first vertex of the first hexagon: lattice place (2, 1), moved to scene coordinates.
    EXPECT_DOUBLE_EQ(points[0], 2.0 + 0.1);
    EXPECT_DOUBLE_EQ(points[1], 1.0 + 0.1 / (2.0 * std::sqrt(3.0)));
}

// Uniaxial compression of 2 MPa turned by 30 degrees: principal stresses 2 MPa and 0.
TEST(Vtu, HoldsStressesWithTheirSigns) {
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    const double angle = std::numbers::pi / 6.0;
    const Vec2 axis(std::cos(angle), std::sin(angle));
    auto fields = testing::affine_fields(system, Mat2::Zero(), -2e6 * axis * axis.transpose());
    fields.stress_zz.assign(2, -5e5);
    const std::string file = blocks_vtu(system, fields, {{"rock"}, {}, {}}, StepRecord{});
    const auto stress = array_of<double>(file, "stress"); // nine numbers a block, positive in compression
    ASSERT_EQ(stress.size(), 18U);
    EXPECT_DOUBLE_EQ(stress[9], 2e6 * std::pow(std::cos(angle), 2));
    EXPECT_DOUBLE_EQ(stress[10], 2e6 * std::cos(angle) * std::sin(angle));
    EXPECT_EQ(stress[11], 0.0);
    EXPECT_EQ(stress[12], stress[10]);
    EXPECT_DOUBLE_EQ(stress[13], 2e6 * std::pow(std::sin(angle), 2));
    EXPECT_EQ(stress[14], 0.0);
    EXPECT_EQ(stress[17], 5e5);
    EXPECT_NEAR(array_of<double>(file, "sigma_1")[1], 2e6, 1e-8);
    EXPECT_NEAR(array_of<double>(file, "sigma_3")[1], 0.0, 1e-8);
    EXPECT_THAT(array_of<std::int32_t>(file, "block"), ElementsAre(0, 1));
    EXPECT_THAT(array_of<std::int32_t>(file, "material"), ElementsAre(0, 0));
}

TEST(Vtu, HoldsDisplacementsOfEachBlocksOwnVertices) {
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    for (std::size_t i = 6; i < 12; ++i) fields.displacement[i] = {0.25, -0.5};
    const auto displacement = array_of<double>(blocks_vtu(system, fields, {}, StepRecord{}), "displacement");
    EXPECT_EQ(displacement[3 * 5], 0.0);
    EXPECT_EQ(displacement[3 * 6], 0.25);
    EXPECT_EQ(displacement[3 * 11 + 1], -0.5);
    EXPECT_EQ(displacement[3 * 11 + 2], 0.0);
    // The only interface moves with the mean of its sides.
    const auto mean = array_of<double>(interfaces_vtu(system, fields, {}, StepRecord{}), "displacement");
    EXPECT_THAT(mean, ElementsAre(0.125, -0.25, 0.0, 0.125, -0.25, 0.0));
}

TEST(Vtu, HoldsInterfacesAsLinesWithTheirStates) {
    const BlockSystem system = testing::hexagon_grid(2, 2, 0.1);
    auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    ASSERT_EQ(fields.interfaces.size(), 5U);
    fields.interfaces[0] = {false, true, CrackMode::tension, ContactState::open, 0.0, 0.0,
                            1e-4,  2e-5, Vec2(1e-4, -2e-5),  Vec2::Zero()};
    fields.interfaces[1] = {false, true, CrackMode::shear, ContactState::sliding, -3e5, 1e5,
                            -1e-6, 3e-4, Vec2::Zero(),     Vec2(2.0, -3.0)};
    fields.interfaces[2] = {false, false, CrackMode::shear, ContactState::locked, -1e5, 0.0,
                            0.0,   0.0,   Vec2::Zero(),     Vec2::Zero()};
    const std::string file = interfaces_vtu(system, fields, {}, StepRecord{});
    EXPECT_EQ(array_of<std::uint8_t>(file, "types"), std::vector<std::uint8_t>(5, 3));
    EXPECT_THAT(array_of<std::int64_t>(file, "connectivity"), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
    EXPECT_THAT(array_of<std::int32_t>(file, "state"), ElementsAre(0, 1, 2, 2, 2));
    EXPECT_THAT(array_of<std::int32_t>(file, "crack_mode"), ElementsAre(1, 2, 0, 0, 0));
    EXPECT_THAT(array_of<std::int32_t>(file, "bonded"), ElementsAre(0, 0, 0, 1, 1));
    EXPECT_EQ(array_of<double>(file, "gap")[0], 1e-4);
    EXPECT_EQ(array_of<double>(file, "slip")[1], 3e-4);
    EXPECT_EQ(array_of<double>(file, "normal_traction")[1], 3e5);
    EXPECT_EQ(array_of<double>(file, "shear_traction")[1], 1e5);
    EXPECT_THAT(array_of<double>(file, "relative_displacement"), ::testing::Contains(-2e-5));
    const auto force = array_of<double>(file, "contact_force");
    EXPECT_THAT(std::vector(force.begin() + 3, force.begin() + 6), ElementsAre(2.0, -3.0, 0.0));
    // Edges of a regular hexagon of width d have the length d/sqrt(3).
    const auto points = array_of<double>(file, "Points");
    for (std::size_t i = 0; i < 5; ++i)
        EXPECT_NEAR(std::hypot(points[6 * i + 3] - points[6 * i], points[6 * i + 4] - points[6 * i + 1]),
                    0.1 / std::sqrt(3.0), 1e-15);
}

TEST(Vtu, ReplacesWhatIsNotANumberAndCountsIt) {
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    fields.displacement[3].x() = std::numeric_limits<double>::quiet_NaN();
    fields.interfaces[0].gap = std::numeric_limits<double>::infinity();
    StepRecord record;
    record.axial_strain = std::numeric_limits<double>::quiet_NaN();
    const std::string blocks = blocks_vtu(system, fields, {}, record);
    EXPECT_THAT(blocks, HasSubstr("Name=\"replaced_values\" NumberOfTuples=\"1\" format=\"ascii\">2<"));
    for (const double value : array_of<double>(blocks, "displacement")) EXPECT_TRUE(std::isfinite(value));
    EXPECT_EQ(array_of<double>(interfaces_vtu(system, fields, {}, record), "gap")[0], 0.0);
}

TEST(Vtu, HasNamesAndUnitsInTheNamesOfFieldData) {
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    const auto fields = testing::affine_fields(system, Mat2::Zero(), Mat2::Zero());
    const FieldNames names{{"rock"}, {"joint", "a < \"b\""}, {"main"}};
    EXPECT_THAT(blocks_vtu(system, fields, names, StepRecord{}),
                HasSubstr("Name=\"material: rock\" NumberOfTuples=\"1\""));
    const std::string file = interfaces_vtu(system, fields, names, StepRecord{});
    EXPECT_THAT(file,
                HasSubstr("Name=\"interface_type: a &lt; &quot;b&quot;\" NumberOfTuples=\"1\" format=\"ascii\">1<"));
    EXPECT_THAT(file, HasSubstr("Name=\"mapped_fracture: main\""));
    EXPECT_THAT(file, HasSubstr("Name=\"unit of gap: m, positive when open\""));
}

// An array of more than one piece: 20 000 hexagons have 120 000 points with three numbers of eight bytes each.
TEST(Vtu, CompressesLargeArraysPieceByPiece) {
    const BlockSystem system = testing::hexagon_grid(200, 100, 0.1);
    Mat2 gradient = Mat2::Zero();
    gradient(1, 0) = 0.25;
    const auto fields = testing::affine_fields(system, gradient, Mat2::Zero());
    const std::string file = blocks_vtu(system, fields, {}, StepRecord{});
    const auto points = array_of<double>(file, "Points");
    const auto displacement = array_of<double>(file, "displacement");
    ASSERT_EQ(points.size(), 360000U);
    ASSERT_EQ(displacement.size(), points.size());
    for (std::size_t i = 0; i < points.size(); i += 3) ASSERT_EQ(displacement[i + 1], 0.25 * points[i]);
    EXPECT_LT(file.size(), 4 * (points.size() + displacement.size()));
}

TEST(BlockOutline, JoinsAHoleByTwoCoincidentBridges) {
    const BlockSystem system = testing::block_with_hole();
    const auto polygon = keyhole_polygon(system, system.blocks[0]);
    EXPECT_EQ(polygon.size(), 4U + 4U + 2U);
    double area = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        area += 0.5 * cross(system.vertices[polygon[i]], system.vertices[polygon[(i + 1) % polygon.size()]]);
    EXPECT_DOUBLE_EQ(area, 8.0);
    EXPECT_EQ(next_edge(system.blocks[0], 3), 0);
    EXPECT_EQ(next_edge(system.blocks[0], 7), 4);
}

} // namespace
} // namespace kluft
