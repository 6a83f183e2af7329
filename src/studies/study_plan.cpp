#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "kluft/core/digest.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/studies/study.hpp"

namespace kluft {

namespace {

constexpr std::size_t longest_name = 100;
constexpr int significant_digits = 12;

/// One choice of the value of each parameter, as indices.
using Combination = std::vector<std::size_t>;

std::vector<Combination> products(const std::vector<StudyParameter>& parameters) {
    std::vector<Combination> all{{}};
    for (const auto& parameter : parameters) {
        std::vector<Combination> longer;
        for (const auto& combination : all) {
            for (std::size_t i = 0; i < parameter.values.size(); ++i) {
                longer.push_back(combination);
                longer.back().push_back(i);
            }
        }
        all = std::move(longer);
    }
    return all;
}

std::vector<Combination> combinations(const std::vector<StudyParameter>& parameters, bool together) {
    if (!together || parameters.empty()) return products(parameters);
    std::vector<Combination> rows;
    for (std::size_t i = 0; i < parameters.front().values.size(); ++i) rows.emplace_back(parameters.size(), i);
    return rows;
}

std::string last_keys(const std::string& path, int n_keys) {
    std::size_t from = path.size();
    for (int i = 0; i < n_keys && from != std::string::npos; ++i)
        from = from == 0 ? std::string::npos : path.rfind('.', from - 1);
    return from == std::string::npos ? path : path.substr(from + 1);
}

/// The end of each parameter's path, as long as it takes to tell them apart.
std::vector<std::string> short_labels(const Study& study) {
    for (int n_keys = 1;; ++n_keys) {
        std::vector<std::string> labels;
        bool whole = true;
        for (const auto& parameter : study.parameters) {
            labels.push_back(last_keys(parameter.key, n_keys));
            whole = whole && labels.back() == parameter.key;
        }
        auto sorted = labels;
        std::ranges::sort(sorted);
        if (whole || std::ranges::adjacent_find(sorted) == sorted.end()) return labels;
    }
}

/// A name for a directory, without blanks; what cannot be in one, and what is too long, is told apart by digits.
std::string directory_name(const std::string& wanted) {
    constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-=,";
    std::string plain = wanted;
    std::erase(plain, ' ');
    std::string name = plain;
    for (char& c : name)
        if (allowed.find(c) == std::string_view::npos) c = '_';
    if (name.starts_with('.') || name.starts_with('-')) name.front() = '_';
    constexpr std::size_t kept = 60;
    return name == plain && name.size() <= longest_name ? name : told_apart(name.substr(0, kept), wanted);
}

std::size_t place_of(const Study& study, const std::string& key) {
    return std::ranges::find(study.parameters, key, &StudyParameter::key) - study.parameters.begin();
}

/// A value for each parameter of the study that the settings say something of; the later ones win.
std::vector<std::string> parameter_values(const Study& study, const std::vector<StudySetting>& set) {
    std::vector<std::string> values(study.parameters.size());
    for (const auto& setting : set) {
        const std::size_t p = place_of(study, setting.key);
        if (p < values.size()) values[p] = setting.value;
    }
    return values;
}

/// "event,steps=25,r0": what has one value in the variant only is left out.
std::string case_name(const Study& study, const StudyVariant& variant, const PlannedCase& one,
                      const std::vector<std::string>& labels) {
    std::vector<std::string> parts;
    if (!variant.name.empty()) parts.push_back(variant.name);
    for (const auto& parameter : variant.vary) {
        if (!variant.name.empty() && parameter.values.size() == 1) continue;
        const std::size_t p = place_of(study, parameter.key);
        parts.push_back(labels[p] + "=" + one.settings[p]);
    }
    if (study.replicas.count > 0) parts.push_back(fmt::format("r{}", one.replica));
    return parts.empty() ? "case" : directory_name(fmt::format("{}", fmt::join(parts, ",")));
}

/// Random bits from a place (splitmix64), the same on every machine.
std::uint64_t scrambled(std::uint64_t state) {
    state += 0x9E3779B97F4A7C15U;
    state = (state ^ (state >> 30U)) * 0xBF58476D1CE4E5B9U;
    state = (state ^ (state >> 27U)) * 0x94D049BB133111EBU;
    return state ^ (state >> 31U);
}

/// Bits of number `which` of a copy.
std::uint64_t bits(const ReplicaPlan& plan, int replica, int which) {
    return scrambled(scrambled(scrambled(static_cast<std::uint64_t>(plan.seed)) + static_cast<std::uint64_t>(replica)) +
                     static_cast<std::uint64_t>(which));
}

double uniform(const ReplicaPlan& plan, int replica, int which) {
    return std::ldexp(static_cast<double>(bits(plan, replica, which) >> 11U), -53);
}

std::string rounded(double value) { return fmt::format("{:.{}g}", value, significant_digits); }

constexpr double degree = std::numbers::pi / 180.0;

using CaseKey = std::tuple<int, std::string, std::vector<std::string>>;

const StudyVariant& variant_of(const Study& study, const PlannedCase& one) {
    return *std::ranges::find(study.variants, one.variant, &StudyVariant::name);
}

bool is_chosen(const Study& study, const std::string& key) {
    return std::ranges::find(study.reference.set, key, &StudySetting::key) != study.reference.set.end();
}

/// The last value that a parameter takes in the variant of a case; its own where it does not vary.
std::string last_value(const Study& study, const PlannedCase& one, std::size_t p) {
    for (const auto& parameter : variant_of(study, one).vary)
        if (parameter.key == study.parameters[p].key) return parameter.values.back().value;
    return one.settings[p];
}

/// Whether a case has the settings of the reference.
bool is_reference(const Study& study, const PlannedCase& one) {
    const StudyReference& reference = study.reference;
    if (reference.variant && *reference.variant != one.variant) return false;
    for (const auto& setting : reference.set)
        if (one.settings[place_of(study, setting.key)] != setting.value) return false;
    const bool last = study.along && !is_chosen(study, study.parameters[*study.along].key) &&
                      !(study.together && !reference.set.empty());
    return !last || one.settings[*study.along] == last_value(study, one, *study.along);
}

/// What a case and its reference have in common. The parameters of a study `together` change all at once.
CaseKey common_key(const Study& study, const PlannedCase& one) {
    std::vector<std::string> settings;
    for (std::size_t p = 0; p < study.parameters.size() && !study.together; ++p)
        if (study.along != p && !is_chosen(study, study.parameters[p].key)) settings.push_back(one.settings[p]);
    return {one.replica, study.reference.variant ? std::string{} : one.variant, std::move(settings)};
}

} // namespace

std::vector<PlannedCase> planned_cases(const Study& study) {
    const auto labels = short_labels(study);
    std::vector<PlannedCase> cases;
    std::set<std::string> names;
    for (const auto& variant : study.variants) {
        for (const auto& combination : combinations(variant.vary, study.together)) {
            for (int replica = 0; replica < std::max(study.replicas.count, 1); ++replica) {
                PlannedCase one;
                one.variant = variant.name;
                one.replica = replica;
                one.set = study.set;
                one.set.insert(one.set.end(), variant.set.begin(), variant.set.end());
                for (std::size_t p = 0; p < combination.size(); ++p)
                    one.set.push_back(variant.vary[p].values[combination[p]]);
                one.settings = parameter_values(study, one.set);
                one.name = case_name(study, variant, one, labels);
                if (!names.insert(one.name).second) one.name = told_apart(one.name, fmt::format("{}", cases.size()));
                cases.push_back(std::move(one));
            }
        }
    }
    return cases;
}

std::vector<StudySetting> replica_settings(const ReplicaPlan& plan, int replica, const ReplicaNet& net) {
    constexpr std::uint64_t largest_seed = 1U << 30U;
    std::vector<StudySetting> settings;
    if (plan.count == 0) return settings;
    if (plan.strength_noise > 0.0) {
        settings.push_back({"cracks.strength_noise", rounded(plan.strength_noise), plan.at});
        settings.push_back({"cracks.strength_seed", std::to_string(bits(plan, replica, 0) % largest_seed), plan.at});
    }
    const bool random = net.voronoi || net.triangles;
    if (random && plan.offset)
        settings.push_back({fmt::format("geometry.tessellation.{}.seed", net.voronoi ? "voronoi" : "triangles"),
                            std::to_string(bits(plan, replica, 4) % largest_seed), plan.at});
    if (random || !net.hexagons) return settings;
    const HexagonLattice* const hexagons = &*net.hexagons;
    const double turned = plan.rotation * (2.0 * uniform(plan, replica, 1) - 1.0) * degree;
    const double angle = hexagons->rotation + turned;
    if (plan.rotation > 0.0)
        settings.push_back({"geometry.tessellation.hexagons.rotation", rounded(angle / degree), plan.at});
    if (plan.offset) {
        const double u = uniform(plan, replica, 2);
        const double v = uniform(plan, replica, 3);
        const Vec2 part = hexagons->spacing * Vec2(u + 0.5 * v, 0.5 * std::numbers::sqrt3 * v);
        const Vec2 moved(std::cos(angle) * part.x() - std::sin(angle) * part.y(),
                         std::sin(angle) * part.x() + std::cos(angle) * part.y());
        const Vec2 offset = hexagons->offset + moved;
        settings.push_back({"geometry.tessellation.hexagons.offset",
                            fmt::format("[{}, {}]", rounded(offset.x()), rounded(offset.y())), plan.at});
    }
    return settings;
}

std::vector<std::optional<std::size_t>> reference_cases(const Study& study, const std::vector<PlannedCase>& cases) {
    const StudyReference& reference = study.reference;
    std::vector<std::optional<std::size_t>> result(cases.size());
    if (reference.kind != StudyReference::Kind::chosen) return result;
    if (!study.along && reference.set.empty() && !reference.variant) return result;
    std::map<CaseKey, std::size_t> places;
    std::map<int, std::set<std::size_t>> of_copy;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        if (!is_reference(study, cases[i])) continue;
        const auto place = places.emplace(common_key(study, cases[i]), i).first;
        of_copy[cases[i].replica].insert(place->second);
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const auto& all = of_copy[cases[i].replica];
        if (const auto found = places.find(common_key(study, cases[i])); found != places.end())
            result[i] = found->second;
        else if (all.size() == 1)
            result[i] = *all.begin();
    }
    return result;
}

} // namespace kluft
