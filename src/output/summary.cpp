#include "kluft/output/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "json_number.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<StepRecord>;

constexpr double sliding_share = 0.01; // of what is closed: from there on a body is not elastic
constexpr double opened_share = 0.01;  // of all joints and contacts: the same
constexpr std::size_t least_elastic_rows = 3;
constexpr double elastic_share = 0.3;       // of the peak differential stress, where there are fewer
constexpr double ratio_slack = 1e-3;        // of Poisson's ratio, for round-off
constexpr double flat_rise = 1e-6;          // of the stresses: what is left over in balance makes such a curve rise
constexpr double same_lateral = 1e-6;       // of the lateral stress: it has not changed
constexpr double fall_after_peak = 0.01;    // of the peak
constexpr double fall_out_of_balance = 0.5; // the same, of rows that are not balanced
constexpr double level_change = 0.01;       // of the differential stress, at most
constexpr double level_lateral = 1e-3;    // of the larger stress: so much changes a strength by less than level_change
constexpr double level_share = 1.0 / 3.0; // of the platen's way, at its end
constexpr double least_level_way = 0.5;   // of that part: what the rows in it must cover
constexpr double residual_share = 0.1;    // of the strain
constexpr double strain_rounding = 1e-9;  // relative
constexpr double locking_rise = 0.05;     // of the largest stress until then

Rows balanced_rows(const Rows& rows) {
    Rows balanced;
    for (const StepRecord& row : rows)
        if (row.balanced && std::isfinite(row.axial_stress) && std::isfinite(row.axial_strain)) balanced.push_back(row);
    return balanced;
}

bool is_at_rest(const StepRecord& row) { return row.axial_stress == 0.0 && row.axial_strain == 0.0; }

/// Balanced rows under load: from the first stage on that moves a platen, where one does. A pressure that was there before, and may be
/// gone, is no strength.
Rows loaded_rows(const Rows& rows, std::optional<int> platen_stage) {
    Rows loaded = balanced_rows(rows);
    std::erase_if(loaded,
                  [&](const StepRecord& row) { return is_at_rest(row) || row.stage < platen_stage.value_or(0); });
    return loaded;
}

/// Of the first stage that moves a platen.
double first_sense(const Rows& rows, int platen_stage) {
    const auto last = std::find_if(rows.rbegin(), rows.rend(), [&](const StepRecord& row) {
        return row.stage == platen_stage && row.axial_strain != 0.0;
    });
    return last != rows.rend() && last->axial_strain < 0.0 ? -1.0 : 1.0;
}

/// Balanced rows up to the first one in which the net may be locked.
Rows rows_with_bonds(const Rows& balanced) {
    const auto loose =
        std::ranges::find_if(balanced, [](const StepRecord& row) { return row.net_broken >= locking_share; });
    return {balanced.begin(), loose == balanced.end() ? loose : loose + 1};
}

std::optional<StepRecord> largest_row(const Rows& rows, double sense) {
    const auto largest =
        std::ranges::max_element(rows, {}, [&](const StepRecord& row) { return sense * row.axial_stress; });
    return largest == rows.end() ? std::nullopt : std::optional(*largest);
}

bool has_lateral_stress_of(const StepRecord& row, const StepRecord& other) {
    const double larger = std::max(std::abs(row.lateral_stress), std::abs(other.lateral_stress));
    return std::abs(row.lateral_stress - other.lateral_stress) <= same_lateral * larger;
}

/// What slides under a given force carries it on less and less of its side, so that the stress there drifts.
bool is_pressed_alike(const StepRecord& row, const StepRecord& other) {
    const double larger = std::max(std::abs(other.lateral_stress), std::abs(other.axial_stress));
    return std::abs(row.lateral_stress - other.lateral_stress) <= level_lateral * larger;
}

/// While the platen stays or goes on: a stress that falls because the platen goes back says nothing of a strength; nor does what it loses
/// because the sides are pressed less, of an elastic body nu' <= 1 of it. Rows out of balance
/// count too: what a splinter leaves over in these, the stress is not known by, but a body that has lost most of it does not carry the
/// peak.
bool falls_after_peak(const Rows& rows, const StepRecord& peak, double sense) {
    if (peak.axial_stress == 0.0) return false;
    const auto lost = [&](double share) { return sense * peak.axial_stress - share * std::abs(peak.axial_stress); };
    const double fallen = lost(fall_after_peak);
    const double collapsed = lost(fall_out_of_balance);
    const double gone_back = sense * peak.axial_strain - strain_rounding * std::abs(peak.axial_strain);
    const auto at = std::ranges::find_if(rows, [&](const StepRecord& row) {
        return row.balanced && row.stage >= peak.stage && sense * row.axial_stress >= sense * peak.axial_stress;
    });
    return std::any_of(at, rows.end(), [&](const StepRecord& row) {
        const double relieved = std::max(0.0, sense * (peak.lateral_stress - row.lateral_stress));
        return sense * row.axial_stress + relieved <= (row.balanced ? fallen : collapsed) &&
               sense * row.axial_strain >= gone_back;
    });
}

/// Whether the rows of a stage of the platen and all that follow end on a level, see CurveNumbers.
bool levels_off(const Rows& rows, double sense) {
    if (rows.empty()) return false;
    const double last = sense * rows.back().axial_strain; // counted from where the platen starts
    const double way = level_share * last;
    const auto begin =
        std::ranges::find_if(rows, [&](const StepRecord& row) { return sense * row.axial_strain >= last - way; });
    if (last - sense * begin->axial_strain < least_level_way * way) return false; // at rest, after one large step
    double least = std::numeric_limits<double>::infinity();
    double largest = -least;
    double strain = -least;
    for (auto row = begin; row != rows.end(); ++row) {
        const bool goes_on = sense * row->axial_strain >= strain;
        if (!row->balanced || !goes_on || !is_pressed_alike(*row, rows.back())) return false;
        strain = sense * row->axial_strain;
        least = std::min(least, sense * row->differential_stress);
        largest = std::max(largest, sense * row->differential_stress);
    }
    return rows.end() - begin > 2 && largest > 0.0 && largest - least <= level_change * largest;
}

/// None where the peak lies in the last fifth of the strain, as where a run ends with the drop behind it: the stress has not settled.
std::optional<double> residual_stress(const Rows& history, int platen_stage, double peak_strain) {
    const Rows rows = balanced_rows(platen_rows(history, platen_stage));
    if (rows.empty()) return std::nullopt;
    const double first = rows.front().axial_strain;
    const double last = rows.back().axial_strain;
    const double range = std::abs(last - first);
    if (std::abs(last - peak_strain) <= 2.0 * residual_share * range) return std::nullopt;
    double sum = 0.0;
    int n_rows = 0;
    // From the end backwards, so that a strain that turns back does not bring earlier rows in.
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
        constexpr double rounding = 1e-9;
        if (std::abs(last - row->axial_strain) > (residual_share + rounding) * range) break;
        sum += row->axial_stress;
        ++n_rows;
    }
    return sum / n_rows;
}

/// Slope of the least-squares line through (x, y).
std::optional<double> slope(const std::vector<std::pair<double, double>>& points) {
    const auto n = static_cast<double>(points.size());
    if (points.size() < 2) return std::nullopt;
    double x_mean = 0.0;
    double y_mean = 0.0;
    for (const auto& [x, y] : points) {
        x_mean += x / n;
        y_mean += y / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    for (const auto& [x, y] : points) {
        xx += (x - x_mean) * (x - x_mean);
        xy += (x - x_mean) * (y - y_mean);
    }
    const double result = xy / xx;
    return std::isfinite(result) ? std::optional(result) : std::nullopt;
}

StepRecord interpolated(const StepRecord& a, const StepRecord& b, double share) {
    StepRecord row = b;
    row.axial_strain = std::lerp(a.axial_strain, b.axial_strain, share);
    row.lateral_strain = std::lerp(a.lateral_strain, b.lateral_strain, share);
    row.differential_stress = std::lerp(a.differential_stress, b.differential_stress, share);
    return row;
}

/// The rows until the differential stress, positive in the sense of the platen, first exceeds `limit`.
Rows rows_up_to(const Rows& rows, double limit, double sense) {
    const auto above =
        std::ranges::find_if(rows, [&](const StepRecord& row) { return sense * row.differential_stress > limit; });
    Rows elastic(rows.begin(), above);
    if (elastic.size() == 1 && above != rows.end()) {
        const double from = sense * elastic.front().differential_stress;
        const double share = (limit - from) / (sense * above->differential_stress - from);
        elastic.push_back(interpolated(elastic.front(), *above, share));
    }
    return elastic;
}

/// The first rows, until more than 1 % of the joints have opened since the platen started, or the platen presses and pulls no more: the
/// body is in parts then, or alone.
Rows rows_in_one_piece(const Rows& rows) {
    double largest = 0.0;
    const auto apart = std::ranges::find_if(rows, [&](const StepRecord& row) {
        const int n_joints = row.open + row.sliding + row.locked;
        if (row.open - rows.front().open > opened_share * n_joints) return true;
        const double stress = std::abs(row.axial_stress);
        if (largest > 0.0 && stress <= flat_rise * largest) return true;
        largest = std::max(largest, stress);
        return false;
    });
    return {rows.begin(), apart};
}

/// The rows up to the peak until a bond fails or more than 1 % of what is closed slides.
Rows rows_before_failure(const Rows& rows, double sense) {
    const auto n_cracks = [](const StepRecord& row) { return row.cracks_tension + row.cracks_shear; };
    const auto peak =
        std::ranges::max_element(rows, {}, [&](const StepRecord& row) { return sense * row.differential_stress; });
    return {rows.begin(), std::find_if(rows.begin(), peak + 1, [&](const StepRecord& row) {
                return n_cracks(row) > n_cracks(rows.front()) ||
                       row.sliding > sliding_share * (row.sliding + row.locked);
            })};
}

/// The first rows, while the platen goes on and the sides are pressed as at the start: what follows has other slopes. All rows where the
/// lateral stress changes from the first one on.
Rows rows_of_one_path(const Rows& rows, double sense) {
    auto last = rows.begin() + 1;
    while (last != rows.end() && has_lateral_stress_of(*last, rows.front()) &&
           sense * last->axial_strain >= sense * std::prev(last)->axial_strain)
        ++last;
    return last == rows.begin() + 1 ? rows : Rows(rows.begin(), last);
}

Rows elastic_rows(const Rows& equilibria, const Rows& rows, int platen_stage, double sense) {
    Rows elastic = rows_before_failure(rows, sense);
    if (elastic.size() >= least_elastic_rows) return elastic;
    double peak = -std::numeric_limits<double>::infinity();
    for (const StepRecord& row : balanced_rows(platen_rows(equilibria, platen_stage)))
        peak = std::max(peak, sense * row.differential_stress);
    return rows_up_to(rows, elastic_share * peak, sense);
}

/// Whether the stress of (strain, stress) stays what it is.
bool is_flat(const std::vector<std::pair<double, double>>& curve) {
    double least = std::numeric_limits<double>::infinity();
    double largest = -least;
    for (const auto& [strain, stress] : curve) {
        least = std::min(least, stress);
        largest = std::max(largest, stress);
    }
    return largest - least <= flat_rise * std::max(std::abs(least), std::abs(largest));
}

bool is_ratio_of_rock(double nu) { return nu >= -ratio_slack && nu <= 0.5 + ratio_slack; }

void add_elastic_constants(const Rows& equilibria, const Rows& history, int platen_stage, Plane plane,
                           CurveNumbers& numbers) {
    const Rows balanced = balanced_rows(platen_rows(history, platen_stage));
    if (balanced.empty() || balanced_rows(platen_rows(equilibria, platen_stage)).empty()) return;
    const double sense = first_sense(history, platen_stage);
    const Rows rows = rows_in_one_piece(rows_of_one_path(balanced, sense));
    std::vector<std::pair<double, double>> stress, lateral;
    for (const StepRecord& row : elastic_rows(equilibria, rows, platen_stage, sense)) {
        stress.emplace_back(row.axial_strain, row.differential_stress);
        lateral.emplace_back(row.axial_strain, -row.lateral_strain);
    }
    numbers.axial_modulus = slope(stress);
    if (is_flat(stress)) numbers.axial_modulus.reset(); // what slides from the start has no modulus
    numbers.lateral_ratio = slope(lateral);
    const bool is_measured =
        std::ranges::any_of(lateral, [](const std::pair<double, double>& point) { return point.second != 0.0; });
    if (!is_measured) numbers.lateral_ratio.reset(); // no two sides between which it could be
    if (!numbers.axial_modulus || !numbers.lateral_ratio) return;
    const double ratio = *numbers.lateral_ratio;
    const double nu = plane == Plane::strain ? ratio / (1.0 + ratio) : ratio;
    const double modulus = plane == Plane::strain ? *numbers.axial_modulus * (1.0 - nu * nu) : *numbers.axial_modulus;
    if (!is_ratio_of_rock(nu) || !std::isfinite(modulus)) return;
    numbers.youngs_modulus = modulus;
    numbers.poissons_ratio = nu;
}

void add_counts(const Rows& history, CurveNumbers& numbers) {
    for (const StepRecord& row : history) {
        numbers.unbalanced_steps += row.balanced ? 0 : 1;
    }
    if (history.empty()) return;
    numbers.steps = history.back().step;
    numbers.cracks_tension = history.back().cracks_tension;
    numbers.cracks_shear = history.back().cracks_shear;
    numbers.jumps = history.back().jumps;
}

constexpr std::array statuses{std::pair{RunStatus::done, "done"},
                              std::pair{RunStatus::no_equilibrium, "no_equilibrium"},
                              std::pair{RunStatus::unbalanced, "unbalanced"},
                              std::pair{RunStatus::collapsed, "collapsed"},
                              std::pair{RunStatus::out_of_resources, "out_of_resources"},
                              std::pair{RunStatus::interrupted, "interrupted"}};

RunStatus status_of(const std::string& name) {
    for (const auto& [status, text] : statuses)
        if (name == text) return status;
    throw InputError(
        "status: expected done, no_equilibrium, unbalanced, collapsed, out_of_resources or interrupted, found '" +
        name + "'");
}

std::optional<double> optional_number(const Json& json, const char* key) {
    if (!json.contains(key)) throw InputError(fmt::format("{}: expected a number or null, found nothing", key));
    const Json& value = json.at(key);
    if (!value.is_null() && !value.is_number())
        throw InputError(fmt::format("{}: expected a number or null, found {}", key, value.dump().substr(0, 40)));
    return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

/// The value of a key that must be there.
template <class Value> void read_key(const Json& json, const char* key, Value& value) {
    const auto found = json.find(key);
    if (found == json.end()) throw InputError(fmt::format("{}: expected a value, found nothing", key));
    try {
        found->get_to(value);
    } catch (const Json::exception&) {
        throw InputError(
            fmt::format("{}: expected a value as a run writes it, found {}", key, found->dump().substr(0, 40)));
    }
}

/// The same of a key that an earlier version does not have.
template <class Value> void read_newer_key(const Json& json, const char* key, Value& value) {
    if (json.contains(key)) read_key(json, key, value);
}

void read_numbers(const Json& json, CurveNumbers& numbers) {
    numbers.peak_stress = optional_number(json, "peak_stress");
    numbers.peak_strain = optional_number(json, "peak_strain");
    read_key(json, "peak_reached", numbers.peak_reached);
    read_newer_key(json, "net_locked", numbers.net_locked);
    read_newer_key(json, "levelled_off", numbers.levelled_off);
    read_newer_key(json, "sides_unloaded", numbers.sides_unloaded);
    numbers.residual_stress = optional_number(json, "residual_stress");
    numbers.youngs_modulus = optional_number(json, "youngs_modulus");
    numbers.poissons_ratio = optional_number(json, "poissons_ratio");
    numbers.axial_modulus = optional_number(json, "axial_modulus");
    numbers.lateral_ratio = optional_number(json, "lateral_ratio");
    read_key(json, "cracks_tension", numbers.cracks_tension);
    read_key(json, "cracks_shear", numbers.cracks_shear);
    read_newer_key(json, "jumps", numbers.jumps);
    read_key(json, "steps", numbers.steps);
    read_key(json, "unbalanced_steps", numbers.unbalanced_steps);
}

/// Throws Json::exception for what is no summary at all.
RunSummary summary_in(const Json& json) {
    (void)json.at("status");
    RunSummary summary;
    std::string status;
    read_key(json, "status", status);
    summary.status = status_of(status);
    read_key(json, "title", summary.title);
    read_numbers(json, summary.numbers);
    if (!json.at("platen_stage").is_null()) read_key(json, "platen_stage", summary.platen_stage.emplace());
    if (!summary.platen_stage) { // an earlier version gave the stress of a load
        summary.numbers.peak_stress.reset();
        summary.numbers.peak_strain.reset();
    }
    read_key(json, "blocks", summary.blocks);
    read_key(json, "interfaces", summary.interfaces);
    read_key(json, "unknowns", summary.unknowns);
    visit_counts(summary.costs, [&](const char* name, int& count) { read_newer_key(json, name, count); });
    summary.costs.elapsed_s = optional_number(json, "elapsed_s").value_or(0.0);
    if (json.contains("loading_cpu_s"))
        summary.costs.loading_cpu_s = optional_number(json, "loading_cpu_s").value_or(0.0);
    if (json.contains("cpu_s")) summary.cpu_s = optional_number(json, "cpu_s").value_or(0.0);
    read_key(json, "peak_memory_bytes", summary.peak_memory_bytes);
    read_key(json, "version", summary.version);
    read_newer_key(json, "blas_core", summary.blas_core);
    for (const Json& each : json.value("falling_blocks", Json::array())) {
        const Json& direction = each.at("direction");
        summary.falling.push_back(
            {each.at("block").get<std::string>(), each.at("stage").get<int>(), each.at("load_factor").get<double>(),
             Vec2(direction.at(0).get<double>(), direction.at(1).get<double>()), each.at("turn").get<int>(),
             each.value("share_of_body", 0.0)}); // an earlier version does not say
    }
    const Json& times = json.at("seconds");
    visit_seconds(summary.costs.seconds, [&](const char* name, double& seconds) {
        if (times.contains(name)) seconds = optional_number(times, name).value_or(0.0);
    });
    read_key(json, "message", summary.message);
    read_newer_key(json, "warnings", summary.warnings);
    visit_results(summary.results, [&](const char* name, std::optional<double>& result) {
        if (json.contains(name)) result = optional_number(json, name);
    });
    read_newer_key(json, "reduced_alone", summary.reduced_alone);
    if (json.value("integrator", "implicit") == "explicit") {
        summary.motion =
            MotionReport{json.at("time_steps").get<long>(), optional_number(json, "time_step").value_or(0.0),
                         optional_number(json, "energy_error").value_or(0.0)};
    }
    return summary;
}

} // namespace

std::vector<StepRecord> platen_rows(const std::vector<StepRecord>& rows, int platen_stage) {
    auto first =
        std::find_if(rows.begin(), rows.end(), [&](const StepRecord& row) { return row.stage >= platen_stage; });
    if (first == rows.begin() || first == rows.end()) return {first, rows.end()};
    std::vector<StepRecord> result(first - 1, rows.end());
    StepRecord& start = result.front(); // strains count from here
    start.axial_strain = start.lateral_strain = start.volumetric_strain = 0.0;
    return result;
}

double platen_sense(const std::vector<StepRecord>& rows, std::optional<int> platen_stage) {
    const Rows loaded = loaded_rows(rows, platen_stage);
    if (!platen_stage) { // given loads press or pull
        const auto size = [](const StepRecord& row) { return std::abs(row.axial_stress); };
        const auto largest = std::ranges::max_element(loaded, {}, size);
        return largest == loaded.end() ? 1.0 : std::copysign(1.0, largest->axial_stress);
    }
    const auto fails = [&](double sense) {
        const auto peak = largest_row(rows_with_bonds(loaded), sense);
        return peak && sense * peak->axial_stress > 0.0 && falls_after_peak(rows, *peak, sense);
    };
    const bool fails_in_compression = fails(1.0);
    if (fails_in_compression != fails(-1.0)) return fails_in_compression ? 1.0 : -1.0;
    double farthest = 0.0;
    for (const StepRecord& row : loaded)
        if (row.axial_stress * row.axial_strain > 0.0 && std::abs(row.axial_strain) > std::abs(farthest))
            farthest = row.axial_strain;
    return farthest != 0.0 ? std::copysign(1.0, farthest) : first_sense(rows, *platen_stage);
}

bool is_net_locked(const std::vector<StepRecord>& rows, std::optional<int> platen_stage) {
    const Rows balanced = loaded_rows(rows, platen_stage);
    const double sense = platen_sense(rows, platen_stage);
    const auto before = largest_row(rows_with_bonds(balanced), sense);
    const auto largest = largest_row(balanced, sense);
    return before &&
           sense * (largest->axial_stress - before->axial_stress) > locking_rise * std::abs(before->axial_stress);
}

std::optional<StepRecord> peak_row(const std::vector<StepRecord>& rows, std::optional<int> platen_stage) {
    const Rows balanced = loaded_rows(rows, platen_stage);
    return largest_row(is_net_locked(rows, platen_stage) ? rows_with_bonds(balanced) : balanced,
                       platen_sense(rows, platen_stage));
}

bool is_unloaded_before_fall(const std::vector<StepRecord>& rows, const StepRecord& peak,
                             std::optional<int> platen_stage) {
    constexpr double of_lateral = 0.02; // of the peak
    constexpr double of_axial = 1e-3;
    const double sense = platen_sense(rows, platen_stage);
    const double fallen = sense * peak.axial_stress - fall_after_peak * std::abs(peak.axial_stress);
    double least = peak.lateral_stress;
    const auto at = std::ranges::find_if(rows, [&](const StepRecord& row) {
        return row.balanced && row.stage == peak.stage && row.axial_stress == peak.axial_stress;
    });
    for (auto row = at; row != rows.end(); ++row) {
        if (!row->balanced) continue;
        const double relieved = std::max(0.0, sense * (peak.lateral_stress - row->lateral_stress));
        if (sense * row->axial_stress + relieved <= fallen) break;
        least = std::min(least, row->lateral_stress);
    }
    return peak.lateral_stress - least >
           std::max(of_lateral * std::abs(peak.lateral_stress), of_axial * std::abs(peak.axial_stress));
}

namespace {

void add_peak_numbers(const Rows& all, const Rows& history, int platen_stage, CurveNumbers& numbers) {
    const auto peak = peak_row(all, platen_stage);
    if (!peak) return;
    const double sense = platen_sense(all, platen_stage);
    numbers.peak_stress = peak->axial_stress;
    numbers.peak_strain = peak->axial_strain;
    numbers.jumps_to_peak = peak->jumps;
    numbers.net_locked = is_net_locked(all, platen_stage);
    numbers.peak_reached = !numbers.net_locked && falls_after_peak(all, *peak, sense);
    numbers.levelled_off =
        !numbers.net_locked && !numbers.peak_reached && levels_off(platen_rows(all, platen_stage), sense);
    numbers.sides_unloaded = is_strength(numbers) && is_unloaded_before_fall(all, *peak, platen_stage);
    if (numbers.peak_reached) numbers.residual_stress = residual_stress(history, platen_stage, peak->axial_strain);
}

void read_with_fractures(double compliance_across, CurveNumbers& numbers) {
    clear_elastic_constants(numbers);
    if (!numbers.axial_modulus || !numbers.lateral_ratio) return;
    const double modulus = 1.0 / (1.0 / *numbers.axial_modulus + compliance_across); // (41a)
    const double nu = (*numbers.lateral_ratio / *numbers.axial_modulus - compliance_across) * modulus;
    if (!(modulus > 0.0) || !std::isfinite(modulus)) return;
    numbers.youngs_modulus = modulus;
    if (is_ratio_of_rock(nu)) numbers.poissons_ratio = nu;
}

} // namespace

CurveNumbers curve_numbers(const std::vector<StepRecord>& equilibria, const std::vector<StepRecord>& history,
                           std::optional<int> platen_stage, Plane plane, std::optional<double> compliance_across) {
    CurveNumbers numbers;
    const Rows& all = equilibria.empty() ? history : equilibria;
    if (platen_stage) {
        add_peak_numbers(all, history, *platen_stage, numbers);
        add_elastic_constants(all, history, *platen_stage, plane, numbers);
        if (compliance_across) read_with_fractures(*compliance_across, numbers);
    }
    add_counts(history, numbers);
    return numbers;
}

void clear_round_off(double modulus, CurveNumbers& numbers) {
    constexpr double round_off = 1e-9;
    const double least = round_off * modulus * std::abs(numbers.peak_strain.value_or(0.0));
    for (std::optional<double>* const stress : {&numbers.peak_stress, &numbers.residual_stress})
        if (*stress && std::abs(**stress) < least) *stress = 0.0;
    if (!numbers.axial_modulus || std::abs(*numbers.axial_modulus) >= round_off * modulus) return;
    for (std::optional<double>* const constant :
         {&numbers.axial_modulus, &numbers.lateral_ratio, &numbers.youngs_modulus, &numbers.poissons_ratio})
        constant->reset();
}

void clear_elastic_constants(CurveNumbers& numbers) {
    numbers.youngs_modulus.reset();
    numbers.poissons_ratio.reset();
}

bool is_strength(const CurveNumbers& numbers) { return numbers.peak_reached || numbers.levelled_off; }

std::string peak_remark(const CurveNumbers& numbers) {
    if (numbers.net_locked) return "net locked";
    if (numbers.sides_unloaded) return "sides unloaded";
    if (numbers.levelled_off) return "levelled off";
    return numbers.peak_reached ? "" : "not yet falling";
}

std::string status_name(RunStatus status) {
    for (const auto& [each, text] : statuses)
        if (status == each) return text;
    return "";
}

namespace {

/// The number that is the run's strength; null where it asks for none.
Json strength_measure(const RunSummary& summary) {
    if (summary.results.factor_of_safety) return "factor_of_safety";
    return summary.platen_stage ? Json("axial_stress") : Json(nullptr);
}

} // namespace

std::string summary_json(const RunSummary& summary) {
    const CurveNumbers& numbers = summary.numbers;
    Json json;
    json["status"] = status_name(summary.status);
    json["title"] = summary.title;
    json["peak_stress"] = json_number(numbers.peak_stress);
    json["peak_strain"] = json_number(numbers.peak_strain);
    json["peak_reached"] = numbers.peak_reached;
    json["levelled_off"] = numbers.levelled_off;
    json["sides_unloaded"] = numbers.sides_unloaded;
    json["strength_measure"] = strength_measure(summary);
    json["net_locked"] = numbers.net_locked;
    json["residual_stress"] = json_number(numbers.residual_stress);
    json["youngs_modulus"] = json_number(numbers.youngs_modulus);
    json["poissons_ratio"] = json_number(numbers.poissons_ratio);
    json["axial_modulus"] = json_number(numbers.axial_modulus);
    json["lateral_ratio"] = json_number(numbers.lateral_ratio);
    visit_results(summary.results,
                  [&](const char* name, const std::optional<double>& result) { json[name] = json_number(result); });
    json["reduced_alone"] = summary.reduced_alone;
    json["cracks_tension"] = numbers.cracks_tension;
    json["cracks_shear"] = numbers.cracks_shear;
    json["jumps"] = numbers.jumps;
    json["blocks"] = summary.blocks;
    json["interfaces"] = summary.interfaces;
    json["unknowns"] = summary.unknowns;
    json["steps"] = numbers.steps;
    json["unbalanced_steps"] = numbers.unbalanced_steps;
    visit_counts(summary.costs, [&](const char* name, int count) { json[name] = count; });
    json["integrator"] = summary.motion ? "explicit" : "implicit";
    if (summary.motion) {
        json["time_steps"] = summary.motion->time_steps;
        json["time_step"] = json_number(summary.motion->time_step);
        json["energy_error"] = json_number(summary.motion->energy_error);
    }
    json["elapsed_s"] = json_number(summary.costs.elapsed_s);
    json["loading_cpu_s"] = json_number(summary.costs.loading_cpu_s);
    json["cpu_s"] = json_number(summary.cpu_s);
    json["peak_memory_bytes"] = summary.peak_memory_bytes;
    json["falling_blocks"] = Json::array();
    for (const FallingBlock& each : summary.falling)
        json["falling_blocks"].push_back({{"block", each.block},
                                          {"stage", each.stage},
                                          {"load_factor", each.load_factor},
                                          {"direction", {each.direction.x(), each.direction.y()}},
                                          {"turn", each.turn},
                                          {"share_of_body", each.share_of_body}});
    json["platen_stage"] = summary.platen_stage ? Json(*summary.platen_stage) : Json(nullptr);
    json["version"] = summary.version;
    json["blas_core"] = summary.blas_core;
    json["message"] = summary.message;
    json["warnings"] = summary.warnings;
    json["seconds"] = Json::object();
    visit_seconds(summary.costs.seconds,
                  [&](const char* name, double seconds) { json["seconds"][name] = json_number(seconds); });
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void write_summary(const std::filesystem::path& path, const RunSummary& summary) {
    write_file(path, summary_json(summary));
}

RunSummary read_summary(const std::filesystem::path& path) {
    const std::string text = read_file(path);
    try {
        return summary_in(Json::parse(text));
    } catch (const Json::parse_error& error) {
        throw InputError(
            fmt::format("{}: expected the summary of a run, found no JSON from byte {} on", path.string(), error.byte));
    } catch (const Json::exception&) {
        throw InputError(path.string() +
                         ": expected the summary of a run, found JSON without all its keys or with other values");
    } catch (const InputError& error) {
        throw InputError(path.string() + ": " + error.what());
    }
}

/// Not the maximum of getrusage, in which the program that started this one counts as well.
std::int64_t peak_memory_bytes() {
    constexpr std::int64_t bytes_per_unit = 1024; // Linux counts kibibytes
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::int64_t peak = 0;
        if (word == "VmHWM:" && status >> peak) return peak * bytes_per_unit;
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss * bytes_per_unit;
}

} // namespace kluft
