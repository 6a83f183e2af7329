// A committed state on the disk (HDF5), from which a run goes on.
#pragma once

#include <filesystem>
#include <string>

#include "kluft/simulation/state.hpp"

namespace kluft {

/// Writes all members of a state, each array with checksums. `fingerprint` says which scene the state belongs to,
/// `scene` is that scene's text. The file appears whole or not at all. Throws ResourceError.
void write_state(const std::filesystem::path& path, const State& state, const std::string& fingerprint,
                 const std::string& scene = {});

/// Reads a state back, bit for bit. Throws InputError when the file is missing, truncated, damaged, not a state, of
/// another version, or has a fingerprint other than `expected_fingerprint`.
[[nodiscard]] State read_state(const std::filesystem::path& path, const std::string& expected_fingerprint);

/// The text of the scene that a saved state belongs to. Throws InputError like read_state, and for a state without it.
[[nodiscard]] std::string read_state_scene(const std::filesystem::path& path);

} // namespace kluft
