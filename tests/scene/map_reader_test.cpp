#include "kluft/scene/map_reader.hpp"

#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {
namespace {

class GeoJson : public testing::Test {
protected:
    std::filesystem::path written(const std::string& text) const {
        std::ofstream(file_) << text;
        return file_;
    }
    std::filesystem::path written_as(const std::string& extension, const std::string& text) {
        std::filesystem::remove(file_);
        file_.replace_extension(extension);
        return written(text);
    }

    void TearDown() override { std::filesystem::remove(file_); }

private:
    std::filesystem::path file_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("kluft_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".geojson");
};

template <typename Read> std::string message_of(Read read) {
    try {
        static_cast<void>(read());
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

std::string feature(const std::string& geometry) {
    return R"({"type": "Feature", "properties": {}, "geometry": )" + geometry + "}";
}

std::string collection(const std::string& features) {
    return R"({"type": "FeatureCollection", "features": [)" + features + "]}";
}

const std::string ring = "[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]";
const std::string hole = "[[1, 1], [1, 2], [2, 2], [1, 1]]";
const std::string polygon = R"({"type": "Polygon", "coordinates": [)" + ring + ", " + hole + "]}";
const std::string line = R"({"type": "LineString", "coordinates": [[0, 0], [1, 2, 99.5]]})";
const std::string lines = R"({"type": "MultiLineString", "coordinates": [[[0, 0], [1, 2]], [[3, 4], [3, 4], [5, 6]]]})";

TEST_F(GeoJson, AnAreaHasItsOutlineAndHolesWithoutTheRepeatedPoint) {
    for (const std::string& text : {polygon, feature(polygon), collection(feature(polygon))}) {
        const MappedArea area = read_map_area({.file = written(text)});
        EXPECT_EQ(area.outline, (Polygon{{0, 0}, {4, 0}, {4, 4}, {0, 4}}));
        ASSERT_EQ(area.holes.size(), 1U);
        EXPECT_EQ(area.holes[0], (Polygon{{1, 1}, {1, 2}, {2, 2}}));
    }
}

TEST_F(GeoJson, ListsInListsToAnyDepthAreRefusedInFewWords) {
    constexpr std::size_t depth = 300'000;
    const std::string deep = std::string(depth, '[') + std::string(depth, ']');
    for (const std::string& position : {deep, "[" + deep + ", 1]", "[1, {\"a\": " + deep + "}]"}) {
        const auto file = written(R"({"type": "LineString", "coordinates": [)" + position + "]}");
        const std::string message = message_of([&] { return read_map_traces({.file = file}); });
        EXPECT_NE(message.find("expected a position [x, y], found a list of "), std::string::npos);
        EXPECT_LT(message.size(), 500U);
    }
}

TEST_F(GeoJson, AKeyThatAnObjectHasTwiceIsRefused) {
    const std::string twice =
        R"({"type": "LineString", "coordinates": [[0, 0], [1, 2]], "coordinates": [[0, 0], [3, 4]]})";
    for (const std::string& text : {twice, feature(twice), collection(feature(line) + ", " + feature(twice))}) {
        const auto file = written(text);
        EXPECT_EQ(message_of([&] { return read_map_traces({.file = file}); }),
                  file.string() + ": expected each key of an object once, found 'coordinates' twice");
    }
    EXPECT_EQ(read_map_traces({.file = written(collection(feature(line) + ", " + feature(line)))}).traces.size(), 2U);
}

TEST_F(GeoJson, ADirectoryIsNoFile) {
    const std::filesystem::path directory = testing::TempDir();
    EXPECT_NE(message_of([&] { return read_map_area({.file = directory}); }).find("found a directory"),
              std::string::npos);
    EXPECT_NE(message_of([&] { return read_map_traces({.file = directory}); }).find("found a directory"),
              std::string::npos);
}

TEST_F(GeoJson, AMultiPolygonOfOnePartIsAnArea) {
    const std::string text = R"({"type": "MultiPolygon", "coordinates": [[)" + ring + "]]}";
    EXPECT_EQ(read_map_area({.file = written(text)}).outline.size(), 4U);
}

TEST_F(GeoJson, TracesComeInTheOrderOfTheFile) {
    const auto traces =
        read_map_traces({.file = written(collection(feature(lines) + "," + feature(line) + "," + feature("null")))})
            .traces;
    ASSERT_EQ(traces.size(), 3U);
    EXPECT_EQ(traces[1].points, (std::vector<Vec2>{{3, 4}, {5, 6}})); // the repeated point is dropped
    EXPECT_EQ(traces[2].points, (std::vector<Vec2>{{0, 0}, {1, 2}})); // the height is left out
}

// What GDAL reads and the program does not: the message has the command that helps, and nothing of a parser.
TEST_F(GeoJson, AMapOfAnotherFormatIsRefusedWithTheCommandThatConvertsIt) {
    for (const char* const format : {".dxf", ".csv", ".kml"}) {
        const auto file = written_as(format, "  0\nSECTION\n  2\nHEADER\n");
        const std::string message = message_of([&] { return read_map_traces({.file = file}); });
        const std::string name = file.string();
        const std::string stem = name.substr(0, name.size() - 4);
        EXPECT_EQ(
            message,
            fmt::format("{}: expected a map in GeoJSON (.geojson, .json), a GeoPackage (.gpkg) or a shapefile (.shp), "
                        "found a file of another format; `ogr2ogr {}.gpkg {}` makes a GeoPackage of what GDAL reads",
                        name, stem, name));
    }
    const auto text = written_as(".txt", R"({"type": "LineString", "coordinates": [[0, 0], [1, 1]]})");
    EXPECT_EQ(read_map_traces({.file = text}).traces.size(), 1U);
}

// The doubles next to the decimals written, as strtod gives them.
TEST_F(GeoJson, CoordinatesKeepAllTheirDigits) {
    const auto traces =
        read_map_traces(
            {.file = written(
                 R"({"type": "LineString", "coordinates": [[466011.860742499120533, 6692139.437837231904268], [1e-3, -0.1]]})")})
            .traces;
    EXPECT_EQ(traces[0].points[0], Vec2(466011.860742499120533, 6692139.437837231904268));
    EXPECT_EQ(traces[0].points[1], Vec2(1e-3, -0.1));
}

TEST_F(GeoJson, ErrorsNameTheFileAndTheFeature) {
    const auto in_area = [this](const std::string& text) {
        const auto file = written(text);
        return message_of([&] { return read_map_area({.file = file}); });
    };
    const auto in_traces = [this](const std::string& text) {
        const auto file = written(text);
        return message_of([&] { return read_map_traces({.file = file}); });
    };
    const std::string missing = "/nowhere/traces.geojson";
    EXPECT_NE(message_of([&] { return read_map_traces({.file = missing}); }).find(missing), std::string::npos);
    EXPECT_NE(in_traces("{\"type\": ").find("found no valid JSON"), std::string::npos);
    EXPECT_NE(in_traces("").find("found no valid JSON"), std::string::npos);
    EXPECT_EQ(in_traces("").find("json.exception"), std::string::npos);
    EXPECT_NE(in_traces("[1, 2]").find("expected a GeoJSON object"), std::string::npos);
    EXPECT_NE(in_traces(R"({"type": "FeatureCollection"})").find("features"), std::string::npos);
    EXPECT_NE(in_traces(collection("")).find("no traces"), std::string::npos);
    EXPECT_NE(in_traces(collection(feature(line) + "," + feature(polygon))).find("feature 1: expected a LineString"),
              std::string::npos);
    EXPECT_NE(in_traces(collection(feature(line) + ", 7")).find("feature 1"), std::string::npos);
    EXPECT_NE(in_traces(R"({"type": "LineString", "coordinates": [[0, 0], [1, "x"]]})").find("[1,\"x\"]"),
              std::string::npos);
    EXPECT_NE(in_traces(R"({"type": "LineString", "coordinates": [[0, 0], [0, 0]]})").find("two different points"),
              std::string::npos);
    EXPECT_NE(in_traces(R"({"type": "LineString", "coordinates": [[0, 0], [1e999, 0]]})"), "accepted");
    EXPECT_NE(in_area(collection(feature(line))).find("feature 0: expected a Polygon"), std::string::npos);
    EXPECT_NE(in_area(collection(feature(polygon) + "," + feature(polygon))).find("found 2"), std::string::npos);
    EXPECT_NE(in_area(collection("")).find("found 0"), std::string::npos);
    EXPECT_NE(in_area(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1]]]})").find("does not end"),
              std::string::npos);
    EXPECT_NE(in_area(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 0]]]})").find("three different"),
              std::string::npos);
    EXPECT_NE(in_area(R"({"type": "Polygon", "coordinates": []})").find("at least one ring"), std::string::npos);
}

// RFC 7946 means degrees where a file says nothing; maps of earlier GeoJSON and of other programs mean metres.
TEST_F(GeoJson, SmallNumbersAboutTheOriginAreMetresAndTheRemarkSaysSo) {
    const auto read = [&](const std::string& coordinates, const std::string& file_crs = "") {
        return read_map_traces(
            {.file = written(R"({"type": "LineString", "coordinates": )" + coordinates + "}"), .file_crs = file_crs});
    };
    EXPECT_NE(read("[[-1, 0.13], [1, 0.24]]").remark.find("`file_crs: local` says that they are not"),
              std::string::npos);
    EXPECT_EQ(read("[[-1, 0.13], [1, 0.24]]", "local").remark, "");
    EXPECT_EQ(read("[[0, 0], [200, 10]]").remark, ""); // no degrees
    EXPECT_EQ(read("[[466011, 6692139], [466012, 6692140]]").remark, "");
}

TEST_F(GeoJson, ASmallAreaFarFromTheOriginIsInDegreesWhereItMayBe) {
    const auto file = written(R"({"type": "LineString", "coordinates": [[11.57, 48.13], [11.573, 48.132]]})");
    const std::string message = message_of([&] { return read_map_traces({.file = file}); });
    EXPECT_NE(message.find("expected metres, found degrees"), std::string::npos);
    EXPECT_NE(message.find("from (11.57, 48.13) to (11.573, 48.132)"), std::string::npos);
    EXPECT_NE(message.find("geometry.crs: EPSG:32632"), std::string::npos); // UTM: zone 32 is 6 to 12 degrees east
    EXPECT_EQ(read_map_traces({.file = file, .file_crs = "local"}).traces[0].points[0], Vec2(11.57, 48.13));
}

TEST_F(GeoJson, ZonesOfTheSouthAndTheWestAreNamed) {
    const auto named = [&](const std::string& place) {
        const auto file = written(R"({"type": "LineString", "coordinates": [)" + place + ", " +
                                  place.substr(0, place.size() - 1) + "01]]}");
        return message_of([&] { return read_map_traces({.file = file}); });
    };
    EXPECT_NE(named("[-70.1, -23.5]").find("EPSG:32719"), std::string::npos); // 72 to 66 degrees west, south
    EXPECT_NE(named("[-122.4, 37.5]").find("EPSG:32610"), std::string::npos);
}

TEST_F(GeoJson, ALayerIsNoPartOfIt) {
    const auto file = written(line);
    EXPECT_NE(message_of([&] { return read_map_traces({.file = file, .layer = "a"}); }).find("GeoJSON, which has none"),
              std::string::npos);
}

} // namespace
} // namespace kluft
