// What a study file says: a scene, what to vary in it, and what to look at.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// A value for a key of the scene.
struct StudySetting {
    std::string key;   ///< path, "stages.1.steps"
    std::string value; ///< YAML text
    TextPosition at;   ///< where the study says it

    /// "key=value", as the option --set takes it.
    [[nodiscard]] std::string assignment() const { return key + "=" + value; }
};

/// As the option --set takes them, in their order.
[[nodiscard]] std::vector<std::string> assignments(const std::vector<StudySetting>& settings);

/// Whether the setting gives the key a value, by itself or within a mapping or list: stages.1={steps: 3} sets stages.1.steps.
[[nodiscard]] bool sets_key(const StudySetting& setting, std::string_view key);

struct StudyParameter {
    std::string key;
    std::vector<StudySetting> values; ///< all of this key
};

/// A named group of settings, and what varies in it.
struct StudyVariant {
    std::string name; ///< empty for the only one of a study without variants
    std::vector<StudySetting> set;
    std::vector<StudyParameter> vary; ///< of the whole study first, then its own
};

/// Copies of each case that differ by a small perturbation, the same ones in every group of settings.
struct ReplicaPlan {
    int count = 0; ///< 0: no copies, nothing is perturbed
    long long seed = 1;
    double strength_noise = 0.01; ///< relative standard deviation of the strengths
    bool offset = false;          ///< moves the net of hexagons by a random part of its period
    double rotation = 0.0;        ///< turns it by at most this angle to either side (degrees)
    TextPosition at;
};

/// What the cases are compared with.
struct StudyReference {
    enum class Kind {
        none,
        chosen,   ///< another case: the same one but for `set`, and the last value of `along` unless `set` has it
        values,   ///< a closed form
        directory ///< another run
    };
    Kind kind = Kind::chosen;
    std::optional<std::string> variant;   ///< of the case that is chosen; that of the compared case without one
    std::vector<StudySetting> set;        ///< parameters and their values
    std::map<std::string, double> values; ///< by quantity
    std::filesystem::path directory;
};

struct Study {
    std::string name; ///< the file's stem
    std::string title;
    std::filesystem::path scene;   ///< absolute
    std::vector<StudySetting> set; ///< the same in all cases
    std::vector<StudyVariant> variants;
    std::vector<StudyParameter> parameters; ///< of all variants, each once with all its values
    /// Per parameter what the scene says with `set` alone, or its default; "" for nothing, "[...]" and "{...}" for lists
    /// and mappings. Empty where the scene cannot be read without a variant.
    std::vector<std::string> own_settings;
    bool together = false; ///< the first values of all parameters, the second ones, ... instead of the product
    ReplicaPlan replicas;
    std::vector<std::string> quantities;
    bool curve = true;
    bool pictures = false; ///< of each case
    StudyReference reference;
    std::optional<std::size_t> along; ///< parameter with numbers as values
    double time_limit = 0.0;          ///< of a case (s); 0: none
};

/// A case before it is run.
struct PlannedCase {
    std::string name; ///< from its settings: "event,steps=25,r0"
    std::string variant;
    std::vector<std::string> settings; ///< per parameter; empty where the variant says nothing of it
    int replica = 0;
    std::vector<StudySetting> set; ///< all settings, the later ones win
    std::string digest;            ///< of the scene with all settings and the files that it names
    std::string refusal;           ///< why the scene and the settings do not go together
    int steps = 1;                 ///< load steps of the scene
    bool resumable = true;         ///< a saved state can be gone on from
};

struct ReadStudy {
    Study study;
    std::vector<PlannedCase> cases;
};

/// Largest number of cases of a study.
inline constexpr std::size_t most_cases = 10000;

/// Reads a study file and checks every key and value of every case against the scene's schema. `overrides`
/// ("key.path=value") are laid on `set`. A case that the scene's reader refuses for the combination of its values has
/// a `refusal`. Throws InputError for what is wrong with the study, all of it at once, as read_scene does; also where
/// all cases are refused.
[[nodiscard]] ReadStudy read_study(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same for a study in memory.
[[nodiscard]] ReadStudy read_study_text(std::string_view text, const std::vector<std::string>& overrides,
                                        const std::filesystem::path& file);

/// Digest of a scene with settings ("key.path=value") and of the files that it names. Throws InputError as read_scene does.
[[nodiscard]] std::string scene_digest(const std::filesystem::path& scene, const std::vector<std::string>& overrides);

/// The cases in the order variant, parameters (the last one changes first), replica. Names and settings only; without
/// the settings of replicas, which depend on the scene.
[[nodiscard]] std::vector<PlannedCase> planned_cases(const Study& study);

/// The net whose place and angle a copy changes.
struct ReplicaNet {
    std::optional<HexagonLattice> hexagons;
    bool voronoi = false;
    bool triangles = false;
};

/// The settings that perturb copy `replica`: strength noise and its seed; of hexagons the rotation (degrees), uniform
/// within +-`plan.rotation` beside the net's own, and the offset (m), a uniform part of the net's period beside its own;
/// of Voronoi cells, which have neither, with `plan.offset` another seed. They depend on the seed and the copy alone;
/// the offset's part of the period too.
[[nodiscard]] std::vector<StudySetting> replica_settings(const ReplicaPlan& plan, int replica, const ReplicaNet& net);

/// For each case the one that it is compared with, if the study has one: of those with the settings of the reference
/// (and the last value of `along`, if that is not among them) the one that is like it in everything else; where none is,
/// the only one that there is. Copies are compared with the same copy.
[[nodiscard]] std::vector<std::optional<std::size_t>> reference_cases(const Study& study,
                                                                      const std::vector<PlannedCase>& cases);

/// The names of all numbers that summary.json may have.
[[nodiscard]] std::vector<std::string> summary_quantities();

} // namespace kluft
