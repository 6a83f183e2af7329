// Map files made and read back by GDAL's own tools, which share no code with the program's reader and writer of maps.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "kluft/maps/gdal.hpp"

namespace kluft::test {

/// What a command of the shell prints, its errors included.
inline std::string printed_by(const std::string& command) {
    std::FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 4096> part{};
    while (pipe != nullptr && std::fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
    if (pipe != nullptr) pclose(pipe);
    return text;
}

/// A directory of maps; tests are skipped where there is neither GDAL nor its tools.
class MapFiles : public ::testing::Test {
protected:
    void SetUp() override {
        if (!gdal_problem().empty()) GTEST_SKIP() << gdal_problem();
        if (printed_by("ogr2ogr --version").find("GDAL") == std::string::npos)
            GTEST_SKIP() << "ogr2ogr is not installed";
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return directory_ / name; }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }

    [[nodiscard]] std::string content(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    /// Runs ogr2ogr in the directory.
    void ogr2ogr(const std::string& words) const {
        const std::string said = printed_by("cd '" + directory_.string() + "' && ogr2ogr " + words);
        ASSERT_EQ(said.find("ERROR"), std::string::npos) << said;
    }

    /// GeoJSON of features: (coordinates, properties) as text; the crs member of EPSG:25832 unless there is another one.
    static std::string geojson(const std::string& features, const std::string& crs = "EPSG::25832") {
        return R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:)" +
               crs + R"("}}, "features": [)" + features + "]}";
    }
    static std::string feature(const std::string& type, const std::string& coordinates,
                               const std::string& properties = "{}") {
        return R"({"type": "Feature", "properties": )" + properties + R"(, "geometry": {"type": ")" + type +
               R"(", "coordinates": )" + coordinates + "}}";
    }

private:
    std::filesystem::path directory_ =
        std::filesystem::path(::testing::TempDir()) /
        (std::string("kluft_maps_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

} // namespace kluft::test
