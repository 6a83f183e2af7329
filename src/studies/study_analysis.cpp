#include "kluft/studies/study_analysis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/nearest_name.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_schema.hpp"
#include "kluft/studies/ensemble.hpp"

namespace kluft {

namespace {

constexpr double same_cost =
    1.1; ///< times the cost of the cheapest settings: processor times of short runs vary by as much

using Values = std::vector<double>;
using CaseValues = std::vector<std::optional<double>>;

/// The rule of the schema for a key path such as stages.1.steps; null where there is none.
const KeyRule* rule_of(std::string_view key) {
    std::string pattern;
    for (std::size_t begin = 0; begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        const std::string_view part = key.substr(begin, end - begin);
        const bool is_index = !part.empty() && part.find_first_not_of("0123456789") == std::string_view::npos;
        pattern = scene_schema().child_pattern(pattern, is_index ? "#" : part);
        if (pattern.empty()) return nullptr;
        begin = end + 1;
    }
    return scene_schema().find(pattern);
}

bool is_step_count(std::string_view key) { return key.starts_with("stages.") && key.ends_with(".steps"); }

bool known(const std::optional<double>& value) { return value && std::isfinite(*value); }

bool is_done(const StudyTable& table, std::size_t index) { return table.cases[index].status == CaseStatus::done; }

/// Whether variants hold settings that the table does not show.
bool variants_matter(const StudyTable& table) {
    std::map<std::pair<std::vector<std::string>, int>, std::string> seen;
    return std::ranges::any_of(table.cases, [&](const StudyCase& each) {
        return seen.emplace(std::pair{each.settings, each.replica}, each.variant).first->second != each.variant;
    });
}

bool refines(const StudyTable& table, std::size_t parameter) {
    return table.along == parameter || parameter_kind(table.parameters[parameter]) == ParameterKind::refinement;
}

std::optional<double> size_of(const StudyTable& table, const StudyGroup& group, std::size_t parameter) {
    return refinement_size(table.parameters[parameter], group.settings[parameter]);
}

/// Series of all groups along one parameter.
std::vector<StudySeries> series_along(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                      std::size_t parameter) {
    std::vector<StudySeries> series;
    std::map<std::vector<std::string>, std::size_t> places;
    const bool with_variants = variants_matter(table);
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const auto size = size_of(table, groups[i], parameter);
        if (!size) continue;
        std::vector<std::string> others = groups[i].settings;
        others[parameter].clear();
        if (with_variants) others.push_back(groups[i].variant);
        const auto [place, is_new] = places.emplace(std::move(others), series.size());
        if (is_new) series.push_back({parameter, {}});
        series[place->second].levels.push_back({i, *size});
    }
    std::erase_if(series, [](const StudySeries& each) { return each.levels.size() < 2; });
    for (StudySeries& each : series) std::ranges::stable_sort(each.levels, std::ranges::greater{}, &SeriesLevel::size);
    return series;
}

/// Of three values at sizes of constant ratio; nothing unless they go one way in steps that become smaller.
std::optional<double> observed_order(double ratio, double q1, double q2, double q3) {
    const double first = q1 - q2;
    const double second = q2 - q3;
    if (first * second <= 0.0 || std::abs(second) >= std::abs(first)) return std::nullopt;
    return std::log(first / second) / std::log(ratio);
}

bool is_believable(double order) {
    constexpr double least = 0.5;
    constexpr double most = 4.5;
    return order >= least && order <= most;
}

bool all_ratios_equal(const Values& sizes) {
    const double first = sizes[0] / sizes[1];
    for (std::size_t i = 1; i + 1 < sizes.size(); ++i)
        if (std::abs(sizes[i] / sizes[i + 1] - first) > 1e-6 * first) return false;
    return first > 1.0;
}

/// One direction, and the later change per change of size not wilder than the first.
bool goes_one_way(const Values& values) {
    for (std::size_t i = 2; i < values.size(); ++i) {
        const double before = values[i - 1] - values[i - 2];
        const double now = values[i] - values[i - 1];
        if (before * now <= 0.0) return false;
    }
    return true;
}

bool steps_become_smaller(const Values& values) {
    for (std::size_t i = 2; i < values.size(); ++i)
        if (std::abs(values[i] - values[i - 1]) >= std::abs(values[i - 1] - values[i - 2])) return false;
    return true;
}

struct PowerFit {
    double limit = 0.0;
    double order = 0.0;
    double residual = 0.0; ///< root of the mean square with n - 3, or 0 for three values
    double square_sum = std::numeric_limits<double>::infinity();
};

/// Least squares of q = q0 + C h^p for a given p.
PowerFit fit_for_order(const Values& sizes, const Values& values, double order) {
    const auto n = static_cast<double>(sizes.size());
    double x_mean = 0.0;
    double y_mean = 0.0;
    Values x;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        x.push_back(std::pow(sizes[i] / sizes.front(), order));
        x_mean += x.back() / n;
        y_mean += values[i] / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        xx += (x[i] - x_mean) * (x[i] - x_mean);
        xy += (x[i] - x_mean) * (values[i] - y_mean);
    }
    PowerFit fit;
    fit.order = order;
    fit.limit = y_mean - xy / xx * x_mean;
    fit.square_sum = 0.0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const double rest = values[i] - fit.limit - xy / xx * x[i];
        fit.square_sum += rest * rest;
    }
    fit.residual = sizes.size() > 3 ? std::sqrt(fit.square_sum / (n - 3.0)) : 0.0;
    return fit;
}

/// The best order: a scan and then golden sections around the best place of it.
PowerFit fit_power(const Values& sizes, const Values& values) {
    constexpr double least = 0.1;
    constexpr double most = 6.0;
    constexpr int n_scan = 120;
    const auto at = [&](double order) { return fit_for_order(sizes, values, order); };
    const double width = (most - least) / n_scan;
    PowerFit best;
    for (int i = 0; i <= n_scan; ++i) {
        const PowerFit fit = at(least + width * i);
        if (fit.square_sum < best.square_sum) best = fit;
    }
    double low = std::max(least, best.order - width);
    double high = std::min(most, best.order + width);
    const double section = 0.5 * (std::sqrt(5.0) - 1.0);
    for (int i = 0; i < 60; ++i) {
        const double a = high - section * (high - low);
        const double b = low + section * (high - low);
        (at(a).square_sum < at(b).square_sum ? high : low) = at(a).square_sum < at(b).square_sum ? b : a;
    }
    return at(0.5 * (low + high));
}

double relative(double difference, double to) {
    return to != 0.0 ? std::abs(difference / to) : std::numeric_limits<double>::infinity();
}

/// Of values that go one way, relative to the finest one.
double three_mean_changes(const Values& values) {
    return relative(3.0 * (values.back() - values.front()) / static_cast<double>(values.size() - 1), values.back());
}

void give_limit(double order, double limit, double difference, Convergence& result) {
    result.kind = ConvergenceKind::monotone;
    result.order = order;
    result.limit = limit;
    result.uncertainty = relative(difference, limit);
}

void extrapolate_equal_ratios(const Values& sizes, const Values& values, Convergence& result) {
    const std::size_t n = values.size();
    const double ratio = sizes[n - 2] / sizes[n - 1];
    const double last = values[n - 1] - values[n - 2];
    const auto order = observed_order(ratio, values[n - 3], values[n - 2], values[n - 1]);
    const auto before = n > 3 ? observed_order(ratio, values[n - 4], values[n - 3], values[n - 2]) : order;
    constexpr double most_different = 1.0;
    if (!order || !before || !is_believable(*order) || std::abs(*order - *before) > most_different) {
        result.uncertainty = three_mean_changes(values);
        return;
    }
    const double correction = last / (std::pow(ratio, *order) - 1.0);
    give_limit(*order, values.back() + correction, 1.25 * correction, result);
}

void extrapolate_by_fit(const Values& sizes, const Values& values, Convergence& result) {
    const PowerFit fit = fit_power(sizes, values);
    const double correction = fit.limit - values.back();
    const double spread = std::abs(values[values.size() - 2] - values.back());
    if (!is_believable(fit.order) || fit.residual > spread) {
        result.uncertainty = three_mean_changes(values);
        return;
    }
    give_limit(fit.order, fit.limit, 1.25 * std::abs(correction) + fit.residual, result);
}

double scatter_of(const Values& values) {
    const auto [least, most] = std::ranges::minmax(values);
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    return least == most ? 0.0 : relative(most - least, mean);
}

void mark_front(std::vector<WorkPoint>& points) {
    double best = std::numeric_limits<double>::infinity();
    for (WorkPoint& point : points) { // ascending in cost, then in error
        point.on_front = point.balanced && point.error < best;
        if (point.balanced) best = std::min(best, point.error);
    }
}

bool contains_case(const StudyGroup& group, const std::vector<bool>& marks) {
    return std::ranges::any_of(group.cases, [&](std::size_t i) { return i < marks.size() && marks[i]; });
}

bool has_table_reference(const StudyTable& table, const StudyGroup& group) {
    return table.reference && std::ranges::find(group.cases, *table.reference) != group.cases.end();
}

/// Equal in all settings but refining ones, nowhere coarser and finer somewhere.
bool is_finer(const StudyTable& table, const StudyGroup& fine, const StudyGroup& coarse, bool with_variants) {
    if (with_variants && fine.variant != coarse.variant) return false;
    bool finer = false;
    for (std::size_t p = 0; p < table.parameters.size(); ++p) {
        if (fine.settings[p] == coarse.settings[p]) continue;
        const auto fine_size = size_of(table, fine, p);
        const auto coarse_size = size_of(table, coarse, p);
        if (!refines(table, p) || !fine_size || !coarse_size || *fine_size > *coarse_size) return false;
        finer = finer || *fine_size < *coarse_size;
    }
    return finer;
}

/// There are finer groups, and the error of each is below the bound.
bool is_confirmed(const StudyTable& table, const std::vector<StudyGroup>& groups,
                  const std::vector<std::optional<double>>& errors, bool with_variants, std::size_t group,
                  double bound) {
    if (has_table_reference(table, groups[group])) return true;
    bool any = false;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        if (!is_finer(table, groups[i], groups[group], with_variants)) continue;
        any = true;
        if (!errors[i] || *errors[i] > bound) return false;
    }
    return any;
}

/// The table's reference counts as confirmed, but nothing finer than it may say so.
bool is_finest_reference(const StudyTable& table, const std::vector<StudyGroup>& groups, bool with_variants,
                         std::size_t group) {
    return has_table_reference(table, groups[group]) && std::ranges::none_of(groups, [&](const StudyGroup& other) {
               return is_finer(table, other, groups[group], with_variants);
           });
}

std::vector<std::string> model_settings(const StudyTable& table, const std::vector<std::string>& settings) {
    std::vector<std::string> some;
    for (std::size_t p = 0; p < settings.size(); ++p)
        if (makes_the_model(table, p)) some.push_back(settings[p]);
    return some;
}

std::vector<std::string> numerical_settings(const StudyTable& table, const std::vector<std::string>& settings) {
    std::vector<std::string> some;
    for (std::size_t p = 0; p < settings.size(); ++p)
        if (!makes_the_model(table, p)) some.push_back(settings[p]);
    return some;
}

/// Settings that make the models of the references.
std::set<std::vector<std::string>> reference_models(const StudyTable& table) {
    std::set<std::vector<std::string>> models;
    const auto marks = reference_marks(table);
    for (std::size_t i = 0; i < marks.size(); ++i)
        if (marks[i]) models.insert(model_settings(table, table.cases[i].settings));
    return models;
}

std::optional<double> reference_cost(const StudyTable& table) {
    StudyGroup references;
    const auto marks = reference_marks(table);
    for (std::size_t i = 0; i < marks.size(); ++i)
        if (marks[i]) references.cases.push_back(i);
    return group_cost(table, references);
}

/// The end of the parameter's path, as long as it takes to tell it from the others.
std::string short_name(const StudyTable& table, std::size_t parameter) {
    const std::string& path = table.parameters[parameter];
    for (std::size_t begin = path.rfind('.'); begin != std::string::npos && begin > 0;
         begin = path.rfind('.', begin - 1)) {
        const std::string end = path.substr(begin);
        const auto n_alike = std::ranges::count_if(
            table.parameters, [&](const std::string& other) { return other.ends_with(end) || "." + other == end; });
        if (n_alike == 1) return end.substr(1);
    }
    return path;
}

/// The setting that most groups have of a parameter, if that is more than half of them.
std::optional<std::string> usual_setting(const std::vector<StudyGroup>& groups, std::size_t parameter) {
    std::map<std::string, std::size_t> counts;
    for (const StudyGroup& group : groups) ++counts[group.settings[parameter]];
    const auto most = std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; });
    if (most == counts.end() || 2 * most->second <= groups.size()) return std::nullopt;
    return most->first;
}

template <typename IsNamed>
std::string words_for(const StudyTable& table, const std::vector<StudyGroup>& groups, std::size_t group,
                      const IsNamed& is_named) {
    std::vector<std::string> words;
    if (variants_matter(table) && !groups[group].variant.empty()) words.push_back(groups[group].variant);
    for (std::size_t p = 0; p < table.parameters.size(); ++p) {
        const std::string& setting = groups[group].settings[p];
        if (setting.empty() || !is_named(p)) continue;
        words.push_back(setting == "null" ? "without " + short_name(table, p)
                                          : fmt::format("{} {}", short_name(table, p), setting));
    }
    if (!words.empty()) return listed(words);
    return groups.size() == 1 ? "all cases" : "usual settings";
}

/// Whether the groups of the references' model have different settings of a parameter.
bool differs_in_model(const std::vector<StudyGroup>& groups, const std::vector<bool>& others, std::size_t group,
                      std::size_t parameter) {
    for (std::size_t i = 0; i < groups.size(); ++i)
        if (!others[i] && groups[i].settings[parameter] != groups[group].settings[parameter]) return true;
    return false;
}

} // namespace

ParameterKind parameter_kind(std::string_view key) {
    static const std::set<std::string_view> refining{
        "solver.tolerance", "solver.balance",         "solver.accuracy",       "solver.detection_every",
        "cracks.every",     "cracks.event_tolerance", "analysis.loading_rate", "analysis.crack_check_interval"};
    static const std::set<std::string_view> models{"analysis.plane", "analysis.kinematics", "analysis.gravity",
                                                   "cracks.criterion"};
    if (is_step_count(key) || refining.contains(key) || key.ends_with(".strength_reduction.tolerance"))
        return ParameterKind::refinement;
    for (const std::string_view methods : {"analysis.", "cracks.", "solver.", "output."})
        if (key.starts_with(methods) && !models.contains(key)) return ParameterKind::method;
    return ParameterKind::model;
}

std::optional<double> setting_number(std::string_view key, std::string_view setting) {
    const KeyRule* const rule = rule_of(key);
    if (rule == nullptr || (rule->type != KeyType::number && rule->type != KeyType::integer))
        return read_number(setting);
    return read_quantity(setting, rule->measure).value;
}

std::optional<double> refinement_size(std::string_view key, std::string_view setting) {
    const auto number = setting_number(key, setting);
    if (!known(number) || *number <= 0.0) return std::nullopt;
    return is_step_count(key) ? 1.0 / *number : *number;
}

std::vector<bool> reference_marks(const StudyTable& table) {
    std::vector<bool> marks(table.cases.size(), false);
    if (table.reference) {
        marks[*table.reference] = true;
        return marks;
    }
    for (std::size_t i = 0; i < marks.size(); ++i) {
        CaseValues errors = table.cases[i].errors;
        errors.push_back(table.cases[i].curve_error);
        std::erase_if(errors, [](const std::optional<double>& error) { return !error; });
        marks[i] = !errors.empty() && std::ranges::all_of(errors, [](const auto& error) { return *error == 0.0; });
    }
    return marks;
}

std::vector<StudyMeasure> study_measures(const StudyTable& table) {
    std::vector<StudyMeasure> measures;
    const auto entry = [](const CaseValues& values, std::size_t i) {
        return i < values.size() ? values[i] : std::nullopt;
    };
    for (std::size_t q = 0; q < table.quantities.size(); ++q) {
        StudyMeasure measure{table.quantities[q], false, {}, {}};
        for (const StudyCase& each : table.cases) {
            measure.values.push_back(entry(each.quantities, q));
            measure.errors.push_back(entry(each.errors, q));
        }
        if (std::ranges::any_of(measure.values, known)) measures.push_back(std::move(measure));
    }
    StudyMeasure curve{"curve", true, CaseValues(table.cases.size()), {}};
    for (const StudyCase& each : table.cases) curve.errors.push_back(each.curve_error);
    if (std::ranges::any_of(curve.errors, known)) measures.push_back(std::move(curve));
    return measures;
}

std::vector<StudyGroup> study_groups(const StudyTable& table) {
    const bool with_variants = variants_matter(table);
    std::vector<StudyGroup> groups;
    std::map<std::vector<std::string>, std::size_t> places;
    for (std::size_t i = 0; i < table.cases.size(); ++i) {
        const StudyCase& each = table.cases[i];
        std::vector<std::string> key = each.settings;
        if (with_variants) key.push_back(each.variant);
        const auto [place, is_new] = places.emplace(std::move(key), groups.size());
        if (is_new) groups.push_back({each.settings, each.variant, {}});
        groups[place->second].cases.push_back(i);
    }
    for (StudyGroup& group : groups)
        std::ranges::stable_sort(group.cases, {}, [&](std::size_t i) { return table.cases[i].replica; });
    return groups;
}

std::optional<double> group_mean(const StudyTable& table, const StudyGroup& group, const CaseValues& values) {
    Values found;
    for (const std::size_t i : group.cases)
        if (is_done(table, i) && known(values[i])) found.push_back(*values[i]);
    if (found.empty()) return std::nullopt;
    return ensemble_statistics(found).mean;
}

std::optional<double> group_cost(const StudyTable& table, const StudyGroup& group) {
    Values found;
    for (const std::size_t i : group.cases)
        if (known(table.cases[i].cpu_s)) found.push_back(*table.cases[i].cpu_s);
    if (found.empty()) return std::nullopt;
    return ensemble_statistics(found).mean;
}

bool all_done(const StudyTable& table, const StudyGroup& group) {
    return std::ranges::all_of(group.cases, [&](std::size_t i) { return is_done(table, i); });
}

std::vector<StudySeries> study_series(const StudyTable& table, const std::vector<StudyGroup>& groups) {
    std::vector<StudySeries> all;
    std::set<std::size_t> met;
    const auto add = [&](const std::vector<StudySeries>& found) {
        for (const StudySeries& series : found)
            for (const SeriesLevel& level : series.levels) met.insert(level.group);
        all.insert(all.end(), found.begin(), found.end());
    };
    if (table.along) add(series_along(table, groups, *table.along));
    const std::set<std::size_t> met_along = met;
    for (std::size_t p = 0; p < table.parameters.size(); ++p) {
        if (table.along == p || !refines(table, p)) continue;
        auto found = series_along(table, groups, p);
        std::erase_if(found, [&](const StudySeries& series) {
            return std::ranges::all_of(series.levels,
                                       [&](const SeriesLevel& level) { return met_along.contains(level.group); });
        });
        add(found);
    }
    return all;
}

SeriesValues series_values(const StudyTable& table, const std::vector<StudyGroup>& groups, const StudySeries& series,
                           const StudyMeasure& measure) {
    const auto replicas_with_value = [&](const StudyGroup& group) {
        std::set<int> replicas;
        for (const std::size_t i : group.cases)
            if (is_done(table, i) && known(measure.values[i])) replicas.insert(table.cases[i].replica);
        return replicas;
    };
    std::optional<std::set<int>> common;
    for (const SeriesLevel& level : series.levels) {
        const auto here = replicas_with_value(groups[level.group]);
        if (here.empty()) continue;
        if (!common) common = here;
        std::erase_if(*common, [&](int replica) { return !here.contains(replica); });
    }
    SeriesValues found;
    if (!common) return found;
    for (const SeriesLevel& level : series.levels) {
        StudyGroup members = groups[level.group];
        if (!common->empty())
            std::erase_if(members.cases, [&](std::size_t i) { return !common->contains(table.cases[i].replica); });
        if (const auto mean = group_mean(table, members, measure.values)) {
            found.sizes.push_back(level.size);
            found.values.push_back(*mean);
            found.groups.push_back(level.group);
        }
    }
    return found;
}

Convergence convergence(const Values& sizes, const Values& values, double noise) {
    Convergence result;
    const std::size_t n = std::min(values.size(), most_judged);
    const Values h(sizes.end() - static_cast<std::ptrdiff_t>(n), sizes.end());
    const Values q(values.end() - static_cast<std::ptrdiff_t>(n), values.end());
    if (n > 1) result.scatter = scatter_of(q);
    if (n < 3) return result;
    if (result.scatter <= noise) {
        result.kind = ConvergenceKind::constant;
        result.limit = q.back();
        result.uncertainty = result.scatter;
        return result;
    }
    const bool equal_ratios = all_ratios_equal(h);
    result.kind = ConvergenceKind::scattered;
    if (!goes_one_way(q) || (equal_ratios && !steps_become_smaller(q))) return result;
    result.kind = ConvergenceKind::unsettled;
    if (equal_ratios)
        extrapolate_equal_ratios(h, q, result);
    else
        extrapolate_by_fit(h, q, result);
    return result;
}

std::vector<WorkPoint> work_precision(const StudyTable& table, const StudyMeasure& measure,
                                      const std::vector<bool>& chosen, const std::vector<bool>& unbalanced) {
    std::vector<WorkPoint> points;
    const auto references = reference_marks(table);
    for (std::size_t i = 0; i < table.cases.size(); ++i) {
        const auto& cost = table.cases[i].cpu_s;
        if (references[i] || !chosen[i] || !is_done(table, i) || !known(cost) || !known(measure.errors[i])) continue;
        points.push_back({i, *cost, std::abs(*measure.errors[i]), !unbalanced[i], false});
    }
    std::ranges::sort(points, {}, [](const WorkPoint& p) { return std::tuple(p.cpu_s, p.error, p.study_case); });
    mark_front(points);
    return points;
}

std::vector<bool> other_model_marks(const StudyTable& table, const std::vector<StudyGroup>& groups) {
    const auto models = reference_models(table);
    std::vector<bool> marks;
    for (const StudyGroup& group : groups)
        marks.push_back(!models.empty() && !models.contains(model_settings(table, group.settings)));
    return marks;
}

std::vector<ModelChoice> model_choices(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                       const StudyMeasure& measure) {
    const auto others = other_model_marks(table, groups);
    std::map<std::vector<std::string>, std::size_t> own_groups; // by the settings that do not make the model
    for (std::size_t i = 0; i < groups.size(); ++i)
        if (!others[i]) own_groups.emplace(numerical_settings(table, groups[i].settings), i);
    std::vector<ModelChoice> choices;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        if (!others[i]) continue;
        const auto own = own_groups.find(numerical_settings(table, groups[i].settings));
        if (own == own_groups.end()) continue;
        ModelChoice choice{i, own->second, std::nullopt, std::nullopt};
        const auto value = group_mean(table, groups[i], measure.values);
        const auto own_value = group_mean(table, groups[own->second], measure.values);
        if (value && own_value && *own_value != 0.0) choice.deviation = *value / *own_value - 1.0;
        const auto cost = group_cost(table, groups[i]);
        const auto own_cost = group_cost(table, groups[own->second]);
        if (cost && own_cost && *own_cost > 0.0) choice.cost_ratio = *cost / *own_cost;
        choices.push_back(choice);
    }
    return choices;
}

std::optional<double> group_error(const StudyTable& table, const StudyGroup& group, const StudyMeasure& measure) {
    Values errors;
    double worst = 0.0;
    for (const std::size_t i : group.cases) {
        if (!is_done(table, i) || !known(measure.errors[i])) return std::nullopt;
        errors.push_back(*measure.errors[i]);
        worst = std::max(worst, std::abs(errors.back()));
    }
    constexpr std::size_t least_members = 3;
    if (errors.size() < least_members) return worst;
    const EnsembleStatistics statistics = ensemble_statistics(errors);
    return std::abs(statistics.mean) + statistics.half_width.value_or(0.0);
}

std::vector<Advice> cheapest_settings(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                      const StudyMeasure& measure, const std::vector<bool>& unbalanced,
                                      const std::vector<double>& bounds) {
    CaseValues errors;
    CaseValues costs;
    std::vector<std::size_t> by_cost;
    const auto others = other_model_marks(table, groups);
    const auto reference = reference_cost(table);
    const bool with_variants = variants_matter(table);
    for (std::size_t i = 0; i < groups.size(); ++i) {
        errors.push_back(group_error(table, groups[i], measure));
        costs.push_back(group_cost(table, groups[i]));
        if (errors[i] && costs[i] && !others[i] && !contains_case(groups[i], unbalanced)) by_cost.push_back(i);
    }
    std::ranges::stable_sort(by_cost, {}, [&](std::size_t i) { return *costs[i]; });
    std::vector<Advice> advice;
    for (const double bound : bounds) {
        Advice each;
        each.bound = bound;
        std::optional<std::size_t> cheapest;
        for (const std::size_t i : by_cost) {
            if (*errors[i] > bound) continue;
            const bool as_cheap = !each.group || *costs[i] <= same_cost * *costs[*cheapest];
            if (!as_cheap) break;
            if (!is_confirmed(table, groups, errors, with_variants, i, bound)) {
                if (!each.group) each.not_confirmed.push_back(i);
                continue;
            }
            if (!cheapest) cheapest = i;
            if (each.group && *errors[i] >= each.error) continue;
            each.group = i;
            each.error = *errors[i];
            each.cpu_s = *costs[i];
            each.is_unconfirmed = is_finest_reference(table, groups, with_variants, i);
            if (known(reference) && *reference > 0.0) each.reference_share = each.cpu_s / *reference;
        }
        advice.push_back(std::move(each));
    }
    return advice;
}

std::string group_label(const StudyTable& table, const std::vector<StudyGroup>& groups, std::size_t group,
                        std::optional<std::size_t> without) {
    return words_for(table, groups, group, [&](std::size_t p) {
        return without != p && (table.along == p || usual_setting(groups, p) != groups[group].settings[p]);
    });
}

std::string series_label(const StudyTable& table, const std::vector<StudyGroup>& groups,
                         const std::vector<StudySeries>& all, const StudySeries& series) {
    const std::size_t first = series.levels.front().group;
    std::set<std::size_t> named;
    for (const StudySeries& other : all) {
        if (other.parameter != series.parameter) continue;
        for (std::size_t p = 0; p < table.parameters.size(); ++p) {
            const std::string& here = groups[first].settings[p];
            const std::string& there = groups[other.levels.front().group].settings[p];
            const bool same = here == there || (there.empty() && is_own_setting(table, p, here));
            if (p != series.parameter && !here.empty() && !same) named.insert(p);
        }
    }
    if (named.empty()) return group_label(table, groups, first, series.parameter);
    return words_for(table, groups, first, [&](std::size_t p) { return named.contains(p); });
}

std::string setting_words(const std::string& key, const std::string& setting) {
    if (setting == "null") return "without " + key;
    if (!is_step_count(key)) return key + " " + setting;
    const std::string stage = key.substr(std::string_view("stages.").size());
    return fmt::format("{} {} of stage {}", setting, setting == "1" ? "step" : "steps",
                       stage.substr(0, stage.find('.')));
}

bool is_own_setting(const StudyTable& table, std::size_t parameter, const std::string& setting) {
    if (setting.empty()) return true;
    if (table.own_settings.empty()) return false;
    const std::string& own = table.own_settings[parameter];
    if (setting == own || (setting == "null" && own.empty())) return true;
    const auto a = setting_number(table.parameters[parameter], setting);
    const auto b = setting_number(table.parameters[parameter], own);
    return a && b && *a == *b;
}

bool makes_the_model(const StudyTable& table, std::size_t parameter) {
    return table.along != parameter && parameter_kind(table.parameters[parameter]) == ParameterKind::model;
}

std::optional<std::size_t> own_group(const StudyTable& table, const std::vector<StudyGroup>& groups) {
    std::optional<std::size_t> nearest;
    double least = std::numeric_limits<double>::infinity();
    if (table.own_settings.empty() || variants_matter(table)) return nearest;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        double distance = 0.0;
        for (std::size_t p = 0; p < table.parameters.size(); ++p) {
            if (is_own_setting(table, p, groups[i].settings[p])) continue;
            const auto size = refinement_size(table.parameters[p], groups[i].settings[p]);
            const auto own = refinement_size(table.parameters[p], table.own_settings[p]);
            distance += table.along == p && size && own ? std::abs(std::log(*size / *own))
                                                        : std::numeric_limits<double>::infinity();
        }
        if (distance >= least) continue;
        least = distance;
        nearest = i;
    }
    return nearest;
}

bool takes_own_steps(const StudyTable& table, const StudyGroup& group) {
    for (std::size_t p = 0; p < table.parameters.size(); ++p)
        if (table.parameters[p] == "solver.accuracy")
            return refinement_size("solver.accuracy", group.settings[p]).has_value();
    return false;
}

std::string advised_settings(const StudyTable& table, const std::vector<StudyGroup>& groups, std::size_t group) {
    const auto others = other_model_marks(table, groups);
    const StudyGroup& advised = groups[group];
    std::vector<std::string> words;
    bool all_own = true;
    if (variants_matter(table) && !advised.variant.empty()) words.push_back(advised.variant);
    for (std::size_t p = 0; p < table.parameters.size(); ++p) {
        if (makes_the_model(table, p)) continue;
        const bool own = is_own_setting(table, p, advised.settings[p]);
        const bool is_named = table.own_settings.empty() ? differs_in_model(groups, others, group, p) : !own;
        all_own = all_own && own;
        if (!advised.settings[p].empty() &&
            (is_named || (table.along == p && !(own && takes_own_steps(table, advised)))))
            words.push_back(setting_words(table.parameters[p], advised.settings[p]));
    }
    if (words.empty()) return "the scene's own settings";
    return all_own && !table.own_settings.empty() ? listed(words) + " as in the scene" : listed(words);
}

std::string model_of_group(const StudyTable& table, const std::vector<StudyGroup>& groups, std::size_t group) {
    std::vector<std::string> words;
    for (std::size_t p = 0; p < table.parameters.size(); ++p) {
        const std::string& setting = groups[group].settings[p];
        const auto is_here = [&](const StudyGroup& each) { return each.settings[p] == setting; };
        if (makes_the_model(table, p) && !setting.empty() && !is_own_setting(table, p, setting) &&
            !std::ranges::all_of(groups, is_here))
            words.push_back(setting_words(table.parameters[p], setting));
    }
    return words.empty() ? "" : listed(words);
}

} // namespace kluft
