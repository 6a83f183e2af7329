// The reader of saved states.
#include <cstdlib>

#include "kluft/output/state_file.hpp"
#include "refused.hpp"

/// Writes a state to begin with where KLUFT_FUZZ_SEED names a file: its format changes too often to be kept.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* const seed = std::getenv("KLUFT_FUZZ_SEED");
    if (seed == nullptr) return 0;
    kluft::State state;
    state.body.displacement = Eigen::VectorXd::LinSpaced(12, -1.0, 1.0);
    state.body.interfaces = {kluft::InterfaceStatus::potential_crack, kluft::InterfaceStatus::fracture};
    state.body.bond_shear = {1.0, -2.0};
    state.body.contacts = {{{0, 1, 2, 3, -1}, {1.25e5, 1e-7}}, {{4, 5, 6, 7, 2}, {-0.1, 0.0}}};
    state.imbalance = {1, 0.25, {{1, kluft::Vec2(0.6, -0.8), 0}}};
    state.memory.near_pairs = {{0, 3}, {2, 1}};
    kluft::write_state(seed, state, "fuzz", "kluft: 1\n", "{}");
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace kluft;
    const fuzz::MemoryFile file(fuzz::text_of(bytes, size));
    fuzz::is_taken([&] { (void)read_state(file.path(), "fuzz"); });
    fuzz::is_taken([&] { (void)read_state_scene(file.path()); });
    fuzz::is_taken([&] { (void)read_state_tables(file.path()); });
    return 0;
}
