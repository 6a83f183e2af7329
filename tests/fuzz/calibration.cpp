// The reader of calibration targets. Their scene may be scenes/base.yaml.
#include "kluft/calibration/calibration.hpp"
#include "refused.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    const std::filesystem::path file = KLUFT_SOURCE_DIR "/tests/fuzz/scenes/calibration.yaml";
    fuzz::is_taken([&] { (void)read_calibration_text(fuzz::text_of(bytes, size), file); });
    return 0;
}
