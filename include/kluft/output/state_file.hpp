// A committed state on the disk (HDF5), from which a run goes on.
#pragma once

#include <filesystem>
#include <string>

#include "kluft/simulation/state.hpp"

namespace kluft {

/// Writes all members of a state, with a digest of the whole at the file's end. `fingerprint` says which scene the state belongs to,
/// `scene` is that scene's text, `tables` says what the tables of the run hold up to this state. The file appears whole or
/// not at all. Throws ResourceError; NoEquilibriumError where a number of the state is none: the file that was there stays.
void write_state(const std::filesystem::path& path, const State& state, const std::string& fingerprint,
                 const std::string& scene = {}, const std::string& tables = {});

/// Reads a state back, bit for bit. Throws InputError when the file is missing, truncated, damaged, not a state, with a
/// number that is none, of another version, or has a fingerprint other than `expected_fingerprint`.
[[nodiscard]] State read_state(const std::filesystem::path& path, const std::string& expected_fingerprint);

/// The fingerprint that a state was saved with. Throws InputError like read_state.
[[nodiscard]] std::string read_state_fingerprint(const std::filesystem::path& path);

/// The text of the scene that a saved state belongs to. Throws InputError like read_state, and for a state without it.
[[nodiscard]] std::string read_state_scene(const std::filesystem::path& path);

/// What was saved with a state of the tables. Throws InputError like read_state_scene.
[[nodiscard]] std::string read_state_tables(const std::filesystem::path& path);

/// The bytes of a state file with this HDF5 image: a line with its digest stands behind it, where HDF5 reads nothing.
[[nodiscard]] std::string sealed(std::string image);

} // namespace kluft
