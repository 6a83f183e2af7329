// The reader of studies. Their scene may be scenes/base.yaml.
#include "kluft/studies/study.hpp"
#include "refused.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    const std::filesystem::path file = KLUFT_SOURCE_DIR "/tests/fuzz/scenes/study.yaml";
    fuzz::is_taken([&] { (void)read_study_text(fuzz::text_of(bytes, size), {}, file); });
    return 0;
}
