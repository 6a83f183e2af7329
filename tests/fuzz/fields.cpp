// The reader of field files: the first byte says how many of the bytes are the blocks' file.
#include "kluft/output/field_reader.hpp"
#include "output/hexagon_grid.hpp"
#include "refused.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    static const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    if (size == 0) return 0;
    const std::string_view text = fuzz::text_of(bytes + 1, size - 1);
    const std::string_view first = text.substr(0, text.size() * bytes[0] / 255);
    const fuzz::MemoryFile blocks(first);
    const fuzz::MemoryFile interfaces(text.substr(first.size()));
    fuzz::is_taken([&] { (void)read_fields(blocks.path(), interfaces.path(), system); });
    return 0;
}
