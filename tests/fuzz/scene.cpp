// The reader of scenes, with the schema's checks.
#include "kluft/scene/scene_reader.hpp"
#include "refused.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    fuzz::is_taken([&] { (void)read_scene_text(fuzz::text_of(bytes, size)); });
    return 0;
}
