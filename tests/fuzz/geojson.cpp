// The readers of areas and traces from GeoJSON.
#include "kluft/scene/map_reader.hpp"
#include "refused.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    const fuzz::MemoryFile file(fuzz::text_of(bytes, size));
    fuzz::is_taken([&] { (void)read_map_area({.file = file.path()}); });
    fuzz::is_taken([&] { (void)read_map_traces({.file = file.path()}); });
    return 0;
}
