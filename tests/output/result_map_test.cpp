#include "kluft/output/result_map.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kluft/maps/map_file.hpp"
#include "output/hexagon_grid.hpp"
#include "support/map_files.hpp"

namespace kluft {
namespace {

double number_in(const MapLayer& layer, std::size_t feature, const std::string& field) {
    for (std::size_t i = 0; i < layer.fields.size(); ++i)
        if (layer.fields[i] == field) return std::get<double>(layer.features[feature].values[i]);
    ADD_FAILURE() << field;
    return 0.0;
}

// A linear motion is that of the centroid in the mean: here (1.5, 1.5) moved by G (1.5, 1.5).
TEST(ResultMap, ABlockWithAHoleMovesAsItsCentroid) {
    const BlockSystem system = testing::block_with_hole();
    Mat2 gradient, stress;
    gradient << 0.01, 0.02, -0.03, 0.04;
    stress << -1e6, 0.0, 0.0, -3e6;
    const auto layers = result_layers(system, testing::affine_fields(system, gradient, stress), {{"rock"}, {}, {}}, "");
    ASSERT_EQ(layers[0].features.size(), 1U);
    EXPECT_EQ(layers[0].features[0].polygons[0].size(), 2U);
    EXPECT_EQ(layers[0].features[0].polygons[0][1].size(), 5U); // closed
    EXPECT_NEAR(number_in(layers[0], 0, "displacement_x"), 0.045, 1e-15);
    EXPECT_NEAR(number_in(layers[0], 0, "displacement_y"), 0.015, 1e-15);
    EXPECT_DOUBLE_EQ(number_in(layers[0], 0, "sigma_1"), 3e6);
    EXPECT_DOUBLE_EQ(number_in(layers[0], 0, "stress_xx"), 1e6);
    EXPECT_EQ(number_in(layers[0], 0, "sigma_1_azimuth"), 0.0); // north, along y
}

// sigma = -s n n^T for n at an angle of 30 degrees from x, which is an azimuth of 60 degrees; and of 150 degrees, -60.
TEST(ResultMap, TheAzimuthIsThatOfTheLargestCompression) {
    const BlockSystem system = testing::block_with_hole();
    for (const double azimuth : {0.0, 60.0, 90.0, 120.0, 179.0}) {
        const double angle = (90.0 - azimuth) * M_PI / 180.0;
        const Vec2 n(std::cos(angle), std::sin(angle));
        const auto layers =
            result_layers(system, testing::affine_fields(system, Mat2::Zero(), -2e6 * n * n.transpose()), {}, "");
        EXPECT_NEAR(number_in(layers[0], 0, "sigma_1_azimuth"), azimuth, 1e-9);
    }
}

using ResultMapFiles = test::MapFiles;

TEST_F(ResultMapFiles, AreReadBackByGdalsToolsAtTheirPlaces) {
    const Vec2 origin(691400.125, 5334600.5);
    const BlockSystem system = testing::hexagon_grid(3, 2, 1.0, origin);
    const auto fields = testing::affine_fields(system, Mat2::Identity(), Mat2::Identity());
    const auto layers = result_layers(system, fields, {{"rock"}, {"joint"}, {}}, "EPSG:25832");
    write("r.gpkg", map_file_content(MapFormat::geopackage, layers));
    write("r.geojson", map_file_content(MapFormat::geojson, layers));
    for (const std::string& sql :
         {std::string("r.gpkg -sql 'SELECT COUNT(*) AS n, MIN(ST_MinX(geom)) AS x FROM blocks' "),
          std::string("r.geojson -sql \"SELECT COUNT(*) AS n, MIN(ST_MinX(geometry)) AS x FROM kluft WHERE "
                      "layer = 'blocks'\" ")}) {
        const std::string said =
            test::printed_by("cd '" + path("").string() + "' && ogrinfo -q -dialect SQLITE " + sql);
        EXPECT_NE(said.find("n (Integer) = 6"), std::string::npos) << said;
        EXPECT_NE(said.find("x (Real) = 691400.125\n"), std::string::npos) << said; // the origin
    }
    const MapLayer read = read_map_layer(path("r.gpkg"), "interfaces");
    EXPECT_EQ(read.crs, "EPSG:25832");
    ASSERT_EQ(read.features.size(), system.interfaces.size());
    EXPECT_EQ(read.features[0].lines, layers[1].features[0].lines); // all digits
    EXPECT_EQ(read.fields, layers[1].fields);
}

} // namespace
} // namespace kluft
