#include <gtest/gtest.h>

#include "kluft/maps/coordinate_system.hpp"

namespace kluft {
namespace {

TEST(CanonicalCrs, OneNameForEachWayToWriteACode) {
    for (const char* text :
         {"EPSG:25832", "epsg:25832", "urn:ogc:def:crs:EPSG::25832", "urn:ogc:def:crs:EPSG:9.6:25832"})
        EXPECT_EQ(canonical_crs(text), "EPSG:25832");
    EXPECT_EQ(canonical_crs("urn:ogc:def:crs:OGC:1.3:CRS84"), "OGC:CRS84");
}

TEST(CanonicalCrs, LeavesWhatIsNoCodeAsItIs) {
    for (const char* text : {"", "local", "PROJCS[\"x\"]", "urn:ogc:def:crs:EPSG", "a:b:c", "https://x/y"})
        EXPECT_EQ(canonical_crs(text), text);
}

} // namespace
} // namespace kluft
