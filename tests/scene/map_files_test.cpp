// GeoPackages and shapefiles written by GDAL's own tools, and coordinate systems.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/maps/coordinate_system.hpp"
#include "kluft/maps/map_file.hpp"
#include "kluft/scene/map_reader.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "scene/scene_text.hpp"
#include "support/map_files.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

using MapFilesOfGdal = test::MapFiles;

std::string refusal_of_traces(const MapRequest& request) {
    testing::internal::CaptureStderr();
    std::string message = "accepted";
    try {
        static_cast<void>(read_map_traces(request));
    } catch (const InputError& error) {
        message = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), ""); // GDAL says nothing of its own
    return message;
}

const std::string two_lines_of_munich = "[[[691400.125, 5334600.25], [691420.5, 5334611.0]], "
                                        "[[691500, 5334700], [691510, 5334700], [691510, 5334720]]]";

// A file that is left of another state of the map: GDAL leaves out the shapes that have no record there, and says nothing.
TEST_F(MapFilesOfGdal, PartsOfAShapefileHaveAsManyRecords) {
    const auto lines = [](int n) {
        std::string all;
        for (int i = 0; i < n; ++i)
            all +=
                (i > 0 ? "," : "") + feature("LineString", fmt::format("[[0, {0}], [5, {0}]]", i), R"({"set": "A"})");
        return geojson(all);
    };
    write("few.geojson", lines(1));
    write("many.geojson", lines(3));
    ogr2ogr("few.shp few.geojson");
    ogr2ogr("many.shp many.geojson");
    EXPECT_EQ(read_map_traces({.file = path("many.shp")}).traces.size(), 3U);
    for (const auto& [ending, found] : {std::pair(".shx", "found 3, 1 and 3"), std::pair(".dbf", "found 3, 3 and 1")}) {
        const std::string name = std::string("many") + ending;
        const std::string whole = content(name);
        write(name, content(std::string("few") + ending));
        EXPECT_THAT(refusal_of_traces({.file = path("many.shp")}),
                    AllOf(HasSubstr("many.shp: expected as many shapes as many.shx and many.dbf have records"),
                          HasSubstr(found)));
        write(name, whole);
    }
    const std::string shapes = content("many.shp");
    write("few.shp", shapes);
    EXPECT_THAT(refusal_of_traces({.file = path("few.shp")}), HasSubstr("found 3, 1 and 1"));

    // Bytes beyond the length that the header gives, and a shape that another one of its number has replaced, are none.
    write("many.shp", shapes + std::string(16, '\0'));
    EXPECT_EQ(read_map_traces({.file = path("many.shp")}).traces.size(), 3U);
    constexpr std::size_t header = 100;
    const std::size_t of_record = (shapes.size() - header) / 3; // bytes, of lines of two points each
    std::string with_old = shapes + shapes.substr(header, of_record);
    const std::size_t words = with_old.size() / 2;
    for (std::size_t i = 0; i < 4; ++i) with_old[24 + i] = static_cast<char>((words >> (8 * (3 - i))) & 0xFF);
    write("many.shp", with_old);
    EXPECT_EQ(read_map_traces({.file = path("many.shp")}).traces.size(), 3U);
}

TEST_F(MapFilesOfGdal, TracesKeepTheirPlacesPartsAndAttributes) {
    write("t.geojson", geojson(feature("MultiLineString", two_lines_of_munich, R"({"set": "A", "no": 1})") + "," +
                               feature("LineString", "[[691600, 5334600, 12.5], [691610, 5334600, 13]]",
                                       R"({"set": null, "no": 2})")));
    ogr2ogr("-f GPKG t.gpkg t.geojson");
    ogr2ogr("t.shp t.geojson");
    for (const std::string name : {"t.geojson", "t.gpkg", "t.shp"}) {
        const MappedTraces read = read_map_traces({.file = path(name), .attribute = "set"});
        EXPECT_EQ(read.crs, "EPSG:25832") << name;
        EXPECT_EQ(read.remark, "");
        ASSERT_EQ(read.traces.size(), 3U) << name;
        EXPECT_EQ(read.traces[0].points, (std::vector<Vec2>{{691400.125, 5334600.25}, {691420.5, 5334611.0}}));
        EXPECT_EQ(read.traces[1].points, (std::vector<Vec2>{{691500, 5334700}, {691510, 5334700}, {691510, 5334720}}));
        EXPECT_EQ(read.traces[2].points, (std::vector<Vec2>{{691600, 5334600}, {691610, 5334600}})); // no height
        EXPECT_EQ(read.traces[1].attribute, "A");
        EXPECT_EQ(read.traces[2].attribute, std::nullopt);
        EXPECT_EQ(read_map_traces({.file = path(name), .attribute = "no"}).traces[2].attribute, "2");
    }
}

TEST_F(MapFilesOfGdal, AnAreaHasItsHoles) {
    const std::string rings = "[[[[691400, 5334600], [691410, 5334600], [691410, 5334610], [691400, 5334610], "
                              "[691400, 5334600]], [[691402, 5334602], [691402, 5334604], [691404, 5334604], "
                              "[691402, 5334602]]]]";
    write("a.geojson", geojson(feature("MultiPolygon", rings)));
    ogr2ogr("-f GPKG a.gpkg a.geojson");
    const MappedArea area = read_map_area({.file = path("a.gpkg")});
    EXPECT_EQ(area.outline.size(), 4U);
    ASSERT_EQ(area.holes.size(), 1U);
    EXPECT_EQ(area.holes[0], (Polygon{{691402, 5334602}, {691402, 5334604}, {691404, 5334604}}));
    EXPECT_THAT(refusal_of_traces({.file = path("a.gpkg")}), HasSubstr("expected a LineString or a MultiLineString"));
}

TEST_F(MapFilesOfGdal, ALayerOfSeveralIsChosenByName) {
    write("t.geojson", geojson(feature("LineString", "[[691400, 5334600], [691410, 5334600]]")));
    write("u.geojson", geojson(feature("LineString", "[[691400, 5334700], [691410, 5334700]]")));
    ogr2ogr("-f GPKG m.gpkg t.geojson -nln joints");
    ogr2ogr("-update m.gpkg u.geojson -nln faults");
    EXPECT_THAT(refusal_of_traces({.file = path("m.gpkg")}),
                HasSubstr("expected `layer` beside `file`, one of joints, faults"));
    EXPECT_EQ(read_map_traces({.file = path("m.gpkg"), .layer = "faults"}).traces[0].points[0].y(), 5334700.0);
    EXPECT_THAT(refusal_of_traces({.file = path("m.gpkg"), .layer = "fault"}),
                AllOf(HasSubstr("(joints, faults), found 'fault'"), HasSubstr("did you mean 'faults'?")));
    EXPECT_THAT(refusal_of_traces({.file = path("t.geojson"), .layer = "joints"}), HasSubstr("beside GeoJSON"));
    EXPECT_THAT(refusal_of_traces({.file = path("m.gpkg"), .layer = "joints", .attribute = "set"}),
                HasSubstr("expected an attribute of its features (none), found 'set'"));
}

// The chords of GDAL span four degrees: those of a half circle of radius 10 m have their corners on it, 46 of them.
TEST_F(MapFilesOfGdal, ArcsBecomeChords) {
    write("c.csv", "id,WKT\n1,\"CIRCULARSTRING (691400 5334600,691410 5334610,691420 5334600)\"\n");
    ogr2ogr("-f GPKG c.gpkg c.csv -oo GEOM_POSSIBLE_NAMES=WKT -a_srs EPSG:25832 -nlt CIRCULARSTRING");
    const MappedTraces read = read_map_traces({.file = path("c.gpkg")});
    ASSERT_EQ(read.traces.size(), 1U);
    EXPECT_EQ(read.traces[0].points.size(), 46U);
    for (const Vec2& point : read.traces[0].points) EXPECT_NEAR((point - Vec2(691410, 5334600)).norm(), 10.0, 1e-6);
}

// On the central meridian x is the false easting, and y the arc of the meridian by 0.9996: an integral over the ellipse
// of GRS 80.
TEST_F(MapFilesOfGdal, DegreesOnTheCentralMeridianAreProjectedToTheArcOfTheMeridian) {
    const auto northing = [](double degrees) {
        const double a = 6378137.0, f = 1.0 / 298.257222101, e2 = f * (2.0 - f);
        const double end = degrees * std::numbers::pi / 180.0;
        constexpr int n = 2000; // Simpson's rule
        double sum = 0.0;
        for (int i = 0; i <= n; ++i) {
            const double weight = i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
            sum += weight * std::pow(1.0 - e2 * std::pow(std::sin(end * i / n), 2.0), -1.5);
        }
        return 0.9996 * a * (1.0 - e2) * sum * end / (3.0 * n);
    };
    write("t.geojson", geojson(feature("LineString", "[[9, 48], [9, 48.001]]"), "OGC:1.3:CRS84"));
    ogr2ogr("-f GPKG t.gpkg t.geojson -a_srs EPSG:4258");
    const MapRequest request{.file = path("t.gpkg"), .scene_crs = "EPSG:25832"};
    const MappedTraces read = read_map_traces(request);
    EXPECT_EQ(read.crs, "EPSG:25832");
    for (const int i : {0, 1}) {
        EXPECT_NEAR(read.traces[0].points[i].x(), 500000.0, 1e-4);
        EXPECT_NEAR(read.traces[0].points[i].y(), northing(i == 0 ? 48.0 : 48.001), 1e-3);
    }
}

// J. P. Snyder, Map projections: a working manual, USGS Professional Paper 1395 (1987), p. 269: the ellipsoid of Clarke 1866,
// k_0 = 0.9996, 40 deg 30' N, 73 deg 30' W from the meridian 75 deg W: x = 127 106.5 m, y = 4 484 124.4 m.
TEST_F(MapFilesOfGdal, DegreesAreProjectedAsInSnydersExample) {
    write("t.geojson", R"({"type": "LineString", "coordinates": [[-73.5, 40.5], [-73.6, 40.5]]})");
    const MapRequest request{.file = path("t.geojson"), .file_crs = "EPSG:4267", .scene_crs = "EPSG:26718"};
    const Vec2 place = read_map_traces(request).traces[0].points[0];
    EXPECT_NEAR(place.x(), 627106.5, 0.05);
    EXPECT_NEAR(place.y(), 4484124.4, 0.05);
}

TEST_F(MapFilesOfGdal, DegreesAndFeetAreNeverTakenForMetres) {
    write("t.geojson", geojson(feature("LineString", "[[11.57, 48.13], [11.571, 48.131]]"), "OGC:1.3:CRS84"));
    ogr2ogr("-f GPKG t.gpkg t.geojson");
    for (const std::string name : {"t.geojson", "t.gpkg"})
        EXPECT_THAT(refusal_of_traces({.file = path(name)}),
                    AllOf(HasSubstr("expected metres, found degrees (WGS 84"), HasSubstr("geometry.crs: EPSG:32632")));
    write("f.geojson",
          geojson(feature("LineString", "[[2000000, 500000], [2000010, 500000]]"), "EPSG::2263")); // US feet
    EXPECT_THAT(refusal_of_traces({.file = path("f.geojson")}), HasSubstr("whose unit has 0.304801 m"));
}

TEST_F(MapFilesOfGdal, UnknownSystemsAndPlacesBeyondAProjectionAreRefused) {
    write("t.geojson", R"({"type": "LineString", "coordinates": [[11.57, 48.13], [11.571, 48.131]]})");
    for (const std::string crs :
         {"EPSG:999999", "t.geojson", "https://example.org/crs", "nonsense", "25832", "PROJCS[]"})
        EXPECT_THAT(refusal_of_traces({.file = path("t.geojson"), .file_crs = crs, .scene_crs = "EPSG:25832"}),
                    AllOf(HasSubstr("expected a coordinate system such as EPSG:25832"), HasSubstr(crs)));
    write("p.geojson", R"({"type": "LineString", "coordinates": [[11.57, 48.13], [99, 0]]})");
    EXPECT_THAT(refusal_of_traces({.file = path("p.geojson"), .scene_crs = "EPSG:25832"}),
                AllOf(HasSubstr("p.geojson: "),
                      HasSubstr("expected a place that can be projected to EPSG:25832, found (99, 0)")));
}

TEST_F(MapFilesOfGdal, DamagedAndEmptyFilesAreRefusedInOneMessage) {
    std::string features;
    for (int i = 0; i < 400; ++i)
        features +=
            (i == 0 ? "" : ",") + feature("LineString", "[[691400, 5334600], [691410, 5334600], [691420, 5334633]]");
    write("t.geojson", geojson(features));
    ogr2ogr("-f GPKG t.gpkg t.geojson");
    ogr2ogr("t.shp t.geojson");
    for (const std::string name : {"t.gpkg", "t.shp"}) {
        const std::string whole = content(name);
        for (const std::size_t size : {std::size_t{0}, std::size_t{10}, whole.size() / 3, whole.size() / 2}) {
            write(name, whole.substr(0, size));
            EXPECT_THAT(refusal_of_traces({.file = path(name)}),
                        AllOf(HasSubstr(name + ": expected a "), Not(HasSubstr("\n"))))
                << name << ' ' << size;
        }
        write(name, whole);
    }
    for (const std::string ending : {"shx", "dbf"}) {
        std::filesystem::rename(path("t." + ending), path("away"));
        EXPECT_THAT(refusal_of_traces({.file = path("t.shp")}),
                    HasSubstr("t.shp: expected t." + ending + " beside it"));
        std::filesystem::rename(path("away"), path("t." + ending));
    }
    ogr2ogr("-f GPKG empty.gpkg t.geojson -where \"1 = 0\" -oo FLATTEN_NESTED_ATTRIBUTES=NO -dialect SQLITE -limit 0");
    EXPECT_THAT(refusal_of_traces({.file = path("empty.gpkg")}), HasSubstr("empty.gpkg: no traces"));
    EXPECT_THAT(refusal_of_traces({.file = path("none.gpkg")}),
                HasSubstr("none.gpkg: expected a map, found no such file"));
    EXPECT_THAT(refusal_of_traces({.file = path("")}), HasSubstr("found a directory"));
}

// Each byte of a small file wrong in turn: refused or read, and nothing else happens.
TEST_F(MapFilesOfGdal, FlippedBytesNeverStopTheProgram) {
    write("t.geojson", geojson(feature("MultiLineString", two_lines_of_munich, R"({"set": "A"})")));
    ogr2ogr("t.shp t.geojson");
    const std::string whole = content("t.shp");
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(~damaged[i]);
        write("t.shp", damaged);
        EXPECT_NE(refusal_of_traces({.file = path("t.shp")}), "");
    }
}

// ---- scenes with maps ----------------------------------------------------------------------------------------------

class ScenesWithMaps : public test::MapFiles {
protected:
    /// The messages of a scene whose domain and fractures are replaced.
    [[nodiscard]] std::vector<std::string> errors(const std::vector<std::string>& overrides) const {
        try {
            static_cast<void>(read_scene_text(test::full_scene, with_window(overrides), path("scene.yaml")));
        } catch (const InputError& error) {
            return error.messages();
        }
        return {};
    }
    [[nodiscard]] Scene read(const std::vector<std::string>& overrides) const {
        return read_scene_text(test::full_scene, with_window(overrides), path("scene.yaml"));
    }

private:
    static std::vector<std::string> with_window(std::vector<std::string> overrides) {
        overrides.insert(overrides.begin(),
                         {"geometry.domain.rectangle={width: 100, height: 100, origin: [691400, 5334600]}",
                          "geometry.tessellation={hexagons: {spacing: 20}, region: null}", "geometry.regions=null"});
        return overrides;
    }
};

/// Three traces in the window, one that its box meets though not itself, one outside.
const std::string five_traces = [] {
    std::string features;
    const auto add = [&](const std::string& set, const std::string& line) {
        features += std::string(features.empty() ? "" : ",") + R"({"type": "Feature", "properties": {"set": )" + set +
                    R"(}, "geometry": {"type": "LineString", "coordinates": )" + line + "}}";
    };
    add("\"A\"", "[[691410, 5334610], [691450, 5334630]]");
    add("\"B\"", "[[691380, 5334650], [691520, 5334660]]");
    add("7", "[[691410, 5334670], [691450, 5334690]]");
    add("\"A\"", "[[691390, 5334605], [691420, 5334580]]");
    add("\"A\"", "[[691900, 5334620], [691910, 5334630]]");
    return R"({"type": "FeatureCollection", "features": [)" + features + "]}";
}();

TEST_F(ScenesWithMaps, AnAttributeChoosesTheInterface) {
    write("t.geojson", five_traces);
    const std::string values =
        "attribute: set, interfaces: [{value: A, interface: seam}, {value: B, interface: joint}]";
    const Scene scene = read({"geometry.fractures=[{file: t.geojson, interface: bond, " + values + "}]"});
    std::vector<std::string> kinds;
    for (const FractureTrace& trace : scene.geometry.fractures)
        kinds.push_back(scene.interface_types[static_cast<std::size_t>(trace.interface_type)].name);
    EXPECT_THAT(kinds, ElementsAre("seam", "joint", "bond", "seam", "seam"));
    EXPECT_THAT(
        errors({"geometry.fractures=[{file: t.geojson, " + values + "}]"}),
        ElementsAre(HasSubstr("geometry.fractures.0.attribute: expected values that `interfaces` names, or `interface` "
                              "for all others, found 1 traces with '7' (1)")));
    EXPECT_THAT(
        errors({"geometry.fractures=[{file: t.geojson, attribute: set}]"}),
        ElementsAre(HasSubstr("expected values that are names of interfaces, or `interface` for all others, found 5 "
                              "traces with '7' (1), 'A' (3), 'B' (1)")));
    EXPECT_THAT(errors({"geometry.fractures=[{file: t.geojson, attribute: sets, interface: joint}]"}),
                ElementsAre(AllOf(HasSubstr("geometry.fractures.0.attribute: "), HasSubstr("(set), found 'sets'"),
                                  HasSubstr("did you mean 'set'?"))));
    EXPECT_THAT(
        errors(
            {"geometry.fractures=[{file: t.geojson, interface: joint, interfaces: [{value: A, interface: joint}]}]"}),
        ElementsAre(HasSubstr("expected `attribute` beside it")));
    EXPECT_THAT(
        errors({"geometry.fractures=[{trace: [[691400, 5334600], [691500, 5334700]], interface: joint, layer: x}]"}),
        ElementsAre(HasSubstr("geometry.fractures.0.layer: expected `file` beside it")));
}

TEST_F(ScenesWithMaps, AValueThatNoTraceOfTheMapHasIsTold) {
    write("t.geojson", five_traces);
    const auto warnings = [&](const std::string& value) {
        return read({"geometry.fractures=[{file: t.geojson, attribute: set, interface: joint, interfaces: [{value: " +
                     value + ", interface: seam}]}]"})
            .warnings;
    };
    const auto outside = HasSubstr("2 of 5 traces lie outside the domain");
    EXPECT_THAT(warnings("A"), ElementsAre(outside));
    EXPECT_THAT(
        warnings("a1"),
        ElementsAre(HasSubstr("geometry.fractures.0.interfaces.0.value: no trace of the map has the value 'a1', "
                              "so that none takes this interface; the values of 'set' are 7, A, B; did you "
                              "mean 'A'?"),
                    outside));
}

TEST_F(ScenesWithMaps, OfManyTracesAMessageNamesThoseOfTheNearestNames) {
    std::string lines;
    for (int i = 0; i < 100; ++i)
        lines += (i > 0 ? ", " : "") + fmt::format("[[691410, {0}], [691450, {0}]]", 5334600 + i);
    write("t.geojson", R"({"type": "MultiLineString", "coordinates": [)" + lines + "]}");
    const auto found = errors({"geometry.fractures=[{name: set, file: t.geojson, interface: joint}]",
                               "output.histories={slip: {fracture: set 7x}}"});
    EXPECT_THAT(found, ElementsAre(HasSubstr("expected the name of a mapped fracture (set 7, set 70, set 71, set 72, "
                                             "set 73, set 74, set 75, set 76 and 92 others), found 'set 7x'")));
}

TEST_F(ScenesWithMaps, OneLineTellsHowManyTracesLieOutside) {
    write("t.geojson", five_traces);
    EXPECT_THAT(read({"geometry.fractures=[{file: t.geojson, interface: joint}]"}).warnings,
                ElementsAre(HasSubstr("geometry.fractures: 2 of 5 traces lie outside the domain")));
}

TEST_F(ScenesWithMaps, TracesInHolesOfTheDomainLieOutsideIt) {
    write("t.geojson", R"({"type": "MultiLineString", "coordinates": [[[691420, 5334610], [691425, 5334615]],
        [[691421, 5334611], [691422, 5334612]]]})");
    const std::vector<std::string> hole{"geometry.domain.holes=[{polygon: [[691415, 5334605], [691430, 5334605], "
                                        "[691430, 5334620], [691415, 5334620]]}]",
                                        "geometry.fractures=[{file: t.geojson, interface: joint}]"};
    EXPECT_THAT(errors(hole), ElementsAre(HasSubstr("found 2 of 2 outside, 2 of them in its holes: they lie from")));
}

TEST_F(ScenesWithMaps, AMapThatLiesElsewhereIsAnErrorThatSaysWhere) {
    write("t.geojson", R"({"type": "LineString", "coordinates": [[466011.8607, 6692139.4378], [466012, 6692140]]})");
    EXPECT_THAT(
        errors({"geometry.fractures=[{file: t.geojson, interface: joint}]"}),
        ElementsAre(HasSubstr("geometry.fractures: expected traces in the domain, which lies from (691400, 5334600) to "
                              "(691500, 5334700), found 1 of 1 outside: they lie from (466011.861, 6692139.438) "
                              "to (466012, 6692140)")));
}

TEST_F(ScenesWithMaps, MapsAreProjectedToTheSystemOfTheScene) {
    write("t.geojson",
          geojson(five_traces.substr(five_traces.find('[') + 1, five_traces.rfind(']') - five_traces.find('[') - 1)));
    ogr2ogr("-f GeoJSON -lco RFC7946=YES -lco COORDINATE_PRECISION=9 d.geojson t.geojson");
    const std::string fractures = "geometry.fractures=[{file: d.geojson, interface: joint}]";
    const Scene scene = read({"geometry.crs=EPSG:25832", fractures});
    EXPECT_EQ(scene.geometry.crs, "EPSG:25832");
    // 1e-9 degrees are 0.1 mm; WGS 84 and ETRS 89 are taken for equal.
    EXPECT_LT((scene.geometry.fractures[0].points[0] - Vec2(691410, 5334610)).norm(), 1e-3);
    EXPECT_THAT(errors({fractures}), ElementsAre(HasSubstr("found degrees")));
    EXPECT_THAT(
        errors({"geometry.crs=EPSG:4326", fractures}),
        ElementsAre(HasSubstr("geometry.crs: expected a coordinate system in metres such as EPSG:25832, found WGS 84"),
                    testing::_));
}

TEST_F(ScenesWithMaps, MapsInTwoSystemsNeedOneToBeProjectedTo) {
    write("t.geojson", geojson(feature("LineString", "[[691410, 5334610], [691450, 5334630]]")));
    ogr2ogr("-f GPKG u.gpkg t.geojson -t_srs EPSG:32633");
    const std::string fractures =
        "geometry.fractures=[{file: t.geojson, interface: joint}, {file: u.gpkg, interface: joint}]";
    EXPECT_THAT(errors({fractures}),
                ElementsAre(AllOf(HasSubstr("u.gpkg: expected the coordinate system of "), HasSubstr("EPSG:25832"),
                                  HasSubstr("`geometry.crs`"), HasSubstr("found EPSG:32633"))));
    const Scene scene = read({"geometry.crs=EPSG:25832", fractures});
    EXPECT_LT((scene.geometry.fractures[0].points[1] - scene.geometry.fractures[1].points[1]).norm(), 1e-3);
}

} // namespace
} // namespace kluft
