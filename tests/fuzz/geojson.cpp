// The readers of areas and traces from GeoJSON.
#include "kluft/scene/geojson.hpp"
#include "refused.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    const fuzz::MemoryFile file(fuzz::text_of(bytes, size));
    fuzz::is_taken([&] { (void)read_geojson_area(file.path()); });
    fuzz::is_taken([&] { (void)read_geojson_traces(file.path()); });
    return 0;
}
