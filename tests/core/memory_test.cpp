#include "kluft/core/memory.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {
namespace {

// In a process of its own, as lack of memory is never forgotten.
TEST(MemoryDeathTest, LackOfMemoryEndsWhatRequiresMemory) {
    require_memory();
    EXPECT_FALSE(memory_ran_out());
    EXPECT_EXIT(
        {
            note_lack_of_memory();
            try {
                require_memory();
            } catch (const ResourceError& error) {
                std::_Exit(memory_ran_out() && std::string(error.what()) == "out of memory" ? 7 : 1);
            }
        },
        ::testing::ExitedWithCode(7), "");
}

} // namespace
} // namespace kluft
