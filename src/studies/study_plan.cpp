#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "digest.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/studies/study.hpp"

namespace kluft {

namespace {

constexpr std::size_t longest_name = 100;
constexpr int significant_digits = 12;

/// One choice of the value of each parameter, as indices.
using Combination = std::vector<std::size_t>;

std::vector<Combination> products(const Study& study) {
    std::vector<Combination> all{{}};
    for (const auto& parameter : study.parameters) {
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

std::vector<Combination> combinations(const Study& study) {
    if (!study.together || study.parameters.empty()) return products(study);
    std::vector<Combination> rows;
    for (std::size_t i = 0; i < study.parameters.front().values.size(); ++i)
        rows.emplace_back(study.parameters.size(), i);
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

/// With eight digits that tell it apart from others.
std::string told_apart(const std::string& name, const std::string& wanted) {
    return name + "-" + Digest().add(wanted).text().substr(0, 8);
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

std::string case_name(const Study& study, const PlannedCase& one, const std::vector<std::string>& labels) {
    std::vector<std::string> parts;
    if (!one.variant.empty()) parts.push_back(one.variant);
    for (std::size_t p = 0; p < labels.size(); ++p) parts.push_back(labels[p] + "=" + one.settings[p]);
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

constexpr double degrees = std::numbers::pi / 180.0;

using CaseKey = std::tuple<std::string, std::vector<std::string>, int>;

std::size_t value_index(const StudyParameter& parameter, const std::string& value) {
    return std::ranges::find(parameter.values, value, &StudySetting::value) - parameter.values.begin();
}

const StudySetting* chosen_value(const Study& study, const StudyParameter& parameter) {
    const auto found = std::ranges::find(study.reference.set, parameter.key, &StudySetting::key);
    return found == study.reference.set.end() ? nullptr : &*found;
}

/// The row of a study `together` that the reference names; without one the last row along, or the case's own.
std::size_t reference_row(const Study& study, const PlannedCase& own) {
    for (const auto& parameter : study.parameters)
        if (const auto* chosen = chosen_value(study, parameter)) return value_index(parameter, chosen->value);
    const auto& first = study.parameters.front();
    return study.along ? first.values.size() - 1 : value_index(first, own.settings.front());
}

std::vector<std::string> reference_settings(const Study& study, const PlannedCase& own) {
    std::vector<std::string> settings = own.settings;
    const bool rows = study.together && !study.parameters.empty();
    const std::size_t row = rows ? reference_row(study, own) : 0;
    for (std::size_t p = 0; p < settings.size(); ++p) {
        const StudyParameter& parameter = study.parameters[p];
        if (rows)
            settings[p] = parameter.values[row].value;
        else if (const auto* chosen = chosen_value(study, parameter))
            settings[p] = chosen->value;
        else if (study.along == p)
            settings[p] = parameter.values.back().value;
    }
    return settings;
}

} // namespace

std::vector<PlannedCase> planned_cases(const Study& study) {
    const auto labels = short_labels(study);
    const auto all = combinations(study);
    const std::vector<StudyVariant> only{{}};
    std::vector<PlannedCase> cases;
    std::set<std::string> names;
    for (const auto& variant : study.variants.empty() ? only : study.variants) {
        for (const auto& combination : all) {
            for (int replica = 0; replica < std::max(study.replicas.count, 1); ++replica) {
                PlannedCase one;
                one.variant = variant.name;
                one.replica = replica;
                one.set = study.set;
                one.set.insert(one.set.end(), variant.set.begin(), variant.set.end());
                for (std::size_t p = 0; p < combination.size(); ++p) {
                    one.set.push_back(study.parameters[p].values[combination[p]]);
                    one.settings.push_back(one.set.back().value);
                }
                one.name = case_name(study, one, labels);
                if (!names.insert(one.name).second) one.name = told_apart(one.name, fmt::format("{}", cases.size()));
                cases.push_back(std::move(one));
            }
        }
    }
    return cases;
}

std::vector<StudySetting> replica_settings(const ReplicaPlan& plan, int replica, const HexagonLattice* hexagons) {
    std::vector<StudySetting> settings;
    if (plan.count == 0) return settings;
    if (plan.strength_noise > 0.0) {
        constexpr std::uint64_t largest_seed = 1U << 30U;
        settings.push_back({"cracks.strength_noise", rounded(plan.strength_noise), plan.at});
        settings.push_back({"cracks.strength_seed", std::to_string(bits(plan, replica, 0) % largest_seed), plan.at});
    }
    if (hexagons == nullptr) return settings;
    const double turned = plan.rotation * (2.0 * uniform(plan, replica, 1) - 1.0) * degrees;
    const double angle = hexagons->rotation + turned;
    if (plan.rotation > 0.0)
        settings.push_back({"geometry.tessellation.hexagons.rotation", rounded(angle / degrees), plan.at});
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
    for (std::size_t i = 0; i < cases.size(); ++i)
        places.emplace(CaseKey(cases[i].variant, cases[i].settings, cases[i].replica), i);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const CaseKey key(reference.variant.value_or(cases[i].variant), reference_settings(study, cases[i]),
                          cases[i].replica);
        if (const auto found = places.find(key); found != places.end()) result[i] = found->second;
    }
    return result;
}

} // namespace kluft
