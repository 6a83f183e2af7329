#include "kluft/studies/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/units.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/studies/earlier_results.hpp"

namespace kluft {

namespace {

/// What write_comparison writes beside compare.json.
constexpr std::array pictures_and_text{"compare.md", "curves.png", "curves.svg", "cracks.png", "cracks.svg"};
constexpr double rounding = 1e-6; ///< of the reach: cracks exactly one spacing apart are matched
const Colour matched_colour = colour(0x1A1A1A);

using Rows = std::vector<StepRecord>;

// ---- cracks ------------------------------------------------------------------------------------------------------

bool has_place(const CrackRecord& crack) { return std::isfinite(crack.x) && std::isfinite(crack.y); }

double distance(const CrackRecord& a, const CrackRecord& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Indices of the cracks that have a place, from left to right.
std::vector<std::size_t> by_x(const std::vector<CrackRecord>& cracks) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < cracks.size(); ++i)
        if (has_place(cracks[i])) order.push_back(i);
    std::ranges::sort(
        order, [&](std::size_t i, std::size_t j) { return std::pair(cracks[i].x, i) < std::pair(cracks[j].x, j); });
    return order;
}

/// All pairs of one mode within reach.
std::vector<CrackMatch> pairs_within(const std::vector<CrackRecord>& a, const std::vector<CrackRecord>& b,
                                     double reach) {
    std::vector<CrackMatch> pairs;
    const auto order = by_x(b);
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!has_place(a[i])) continue;
        auto at = std::ranges::lower_bound(order, a[i].x - reach, {}, [&](std::size_t j) { return b[j].x; });
        for (; at != order.end() && b[*at].x <= a[i].x + reach; ++at) {
            const double apart = distance(a[i], b[*at]);
            if (a[i].mode == b[*at].mode && apart <= reach) pairs.push_back({i, *at, apart});
        }
    }
    return pairs;
}

// ---- curves ------------------------------------------------------------------------------------------------------

/// Stress of a growing curve at a strain inside its range.
double stress_at(const std::vector<Vec2>& curve, double strain) {
    const auto after = std::ranges::lower_bound(curve, strain, {}, [](const Vec2& point) { return point.x(); });
    if (after == curve.begin()) return curve.front().y();
    if (after == curve.end()) return curve.back().y();
    const Vec2& low = *(after - 1);
    const double share = (strain - low.x()) / (after->x() - low.x());
    return low.y() + share * (after->y() - low.y());
}

// ---- the table ---------------------------------------------------------------------------------------------------

std::optional<double> finite(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<double> relative_difference(const std::optional<double>& a, const std::optional<double>& b) {
    if (!a || !b) return std::nullopt;
    if (*a == *b) return 0.0;
    return *a == 0.0 ? std::nullopt : finite((*b - *a) / std::abs(*a));
}

/// Fills a table row by row.
class TableWriter {
public:
    explicit TableWriter(ComparisonTable& table) : table_(table) {}

    ComparedQuantity& add(std::string key, std::string name, std::string unit, double unit_size,
                          const std::optional<double>& a, const std::optional<double>& b) {
        ComparedQuantity quantity{std::move(key), std::move(name), std::move(unit), unit_size, finite(a), finite(b)};
        quantity.difference = relative_difference(quantity.a, quantity.b);
        return table_.quantities.emplace_back(std::move(quantity));
    }
    void add_count(std::string key, std::string name, const std::optional<double>& a, const std::optional<double>& b) {
        add(std::move(key), std::move(name), "", 1.0, a, b);
    }
    /// What is known of neither run is not judged.
    void judge(ComparedQuantity& quantity) const {
        if (!quantity.a && !quantity.b && !quantity.difference) return;
        const bool within = quantity.difference && std::abs(*quantity.difference) <= table_.tolerance;
        quantity.verdict = within ? Verdict::within : Verdict::missed;
    }

private:
    ComparisonTable& table_;
};

ComparedRun compared_run(const FinishedRun& run) {
    ComparedRun compared;
    compared.name = run.name;
    compared.directory = run.directory.string();
    if (run.summary) {
        compared.title = run.summary->title;
        compared.status = status_name(run.summary->status);
        compared.integrator = run.summary->motion ? "explicit" : "implicit";
    }
    if (run.model) {
        compared.blocks = run.model->system.n_blocks();
    } else if (run.summary) {
        compared.blocks = run.summary->blocks;
    }
    return compared;
}

/// From the summary; of a killed run from its cracks, or else from the last row.
std::optional<double> n_cracks(const FinishedRun& run, CrackMode mode) {
    if (!run.summary && run.cracks)
        return static_cast<double>(std::ranges::count(*run.cracks, mode, &CrackRecord::mode));
    return mode == CrackMode::tension ? run.numbers.cracks_tension : run.numbers.cracks_shear;
}

std::optional<double> matched_share(const FinishedRun& run, std::size_t n_matched) {
    if (!run.cracks || run.cracks->empty()) return std::nullopt;
    return static_cast<double>(n_matched) / static_cast<double>(run.cracks->size());
}

/// The larger spacing of the bodies that are known.
std::optional<double> matching_distance(const FinishedRun& a, const FinishedRun& b) {
    std::optional<double> distance;
    for (const FinishedRun* run : {&a, &b})
        if (run->model) distance = std::max(distance.value_or(0.0), run->model->system.spacing);
    return distance;
}

std::optional<CurveDifference> difference_of_curves(const FinishedRun& a, const FinishedRun& b) {
    const auto peak = peak_row(a.fine_rows(), a.platen_stage);
    if (!a.platen_stage || !b.platen_stage || !peak || !a.numbers.peak_strain || !b.numbers.peak_strain)
        return std::nullopt;
    if (*a.numbers.peak_strain * *b.numbers.peak_strain < 0.0) return std::nullopt; // one pressed, one pulled
    return curve_difference(platen_rows(a.fine_rows(), a.platen_stage.value_or(0)),
                            platen_rows(b.fine_rows(), b.platen_stage.value_or(0)),
                            std::min(std::abs(*a.numbers.peak_strain), std::abs(*b.numbers.peak_strain)),
                            std::abs(peak->differential_stress));
}

/// Whether the run was stopped before its stress had a peak: it might have gone on to any.
bool is_short_of_peak(const FinishedRun& run) {
    const bool ended = run.summary && run.summary->status != RunStatus::interrupted;
    return run.platen_stage && !ended && !is_strength(run.numbers);
}

void add_mechanics(const FinishedRun& of_a, const FinishedRun& of_b, TableWriter& writer) {
    const CurveNumbers& a = of_a.numbers;
    const CurveNumbers& b = of_b.numbers;
    const auto judge = [&](ComparedQuantity& quantity) { writer.judge(quantity); };
    const auto judge_peak = [&](ComparedQuantity& quantity) {
        if (is_short_of_peak(of_a) != is_short_of_peak(of_b)) quantity.difference.reset();
        writer.judge(quantity);
    };
    judge_peak(writer.add("peak_stress", "peak axial stress", "MPa", mega, a.peak_stress, b.peak_stress));
    judge_peak(writer.add("peak_strain", "peak strain", "%", 1.0 / percent, a.peak_strain, b.peak_strain));
    judge(writer.add("youngs_modulus", "Young's modulus", "MPa", mega, a.youngs_modulus, b.youngs_modulus));
    writer.add("poissons_ratio", "Poisson's ratio", "", 1.0, a.poissons_ratio, b.poissons_ratio);
    writer.add("residual_stress", "residual axial stress", "MPa", mega, a.residual_stress, b.residual_stress);
}

/// Of runs without a strength: how far their loads went. At another stage the factors say nothing.
void add_load(const FinishedRun& a, const FinishedRun& b, TableWriter& writer) {
    const auto last = [](const FinishedRun& run) {
        const auto row = std::find_if(run.history.rbegin(), run.history.rend(),
                                      [](const StepRecord& each) { return each.balanced && each.load_factor > 0.0; });
        return row == run.history.rend() ? std::nullopt : std::optional(*row);
    };
    const auto of_a = last(a);
    const auto of_b = last(b);
    const auto factor = [](const std::optional<StepRecord>& row) {
        return row ? std::optional(row->load_factor) : std::nullopt;
    };
    ComparedQuantity& load = writer.add("load_factor", "last load factor", "", 1.0, factor(of_a), factor(of_b));
    if (of_a && of_b && of_a->stage != of_b->stage) load.difference.reset();
    writer.judge(load);
}

void add_cracks(const FinishedRun& a, const FinishedRun& b, const Comparison& comparison, TableWriter& writer) {
    writer.add_count("cracks_tension", "cracks in tension", n_cracks(a, CrackMode::tension),
                     n_cracks(b, CrackMode::tension));
    writer.add_count("cracks_shear", "cracks in shear", n_cracks(a, CrackMode::shear), n_cracks(b, CrackMode::shear));
    std::optional<double> matched, share_a, share_b;
    const std::size_t n_matched = comparison.matches.size();
    if (comparison.table.matching_distance) {
        matched = static_cast<double>(n_matched);
        share_a = matched_share(a, n_matched);
        share_b = matched_share(b, n_matched);
    }
    writer.add("matched_cracks", "matched cracks", "", 1.0, matched, matched).difference.reset();
    writer.add("matched_share", "share of cracks matched", "%", 1.0 / percent, share_a, share_b).difference.reset();
}

void add_curves(const std::optional<CurveDifference>& difference, TableWriter& writer) {
    ComparedQuantity& largest = writer.add("curve_largest", "curves, largest difference", "", 1.0, {}, {});
    if (difference) largest.difference = finite(difference->largest);
    ComparedQuantity& mean = writer.add("curve_mean", "curves, mean difference", "", 1.0, {}, {});
    if (difference) mean.difference = finite(difference->mean);
    writer.judge(mean);
}

std::optional<double> time_steps(const FinishedRun& run) {
    if (!run.summary || !run.summary->motion) return std::nullopt;
    return static_cast<double>(run.summary->motion->time_steps);
}

/// Linear solves, of which an explicit run has none.
std::optional<double> solves(const FinishedRun& run) {
    if (run.summary && run.summary->motion) return std::nullopt;
    if (run.summary) return run.summary->costs.open_close_iterations;
    double sum = 0.0;
    for (const StepRecord& row : run.history) sum += row.open_close_iterations;
    return sum;
}

std::optional<double> elapsed(const FinishedRun& run) {
    if (run.summary) return run.summary->costs.elapsed_s;
    return run.history.back().elapsed_s > 0.0 ? std::optional(run.history.back().elapsed_s) : std::nullopt;
}

void add_costs(const FinishedRun& a, const FinishedRun& b, TableWriter& writer) {
    writer.add_count("steps", "load steps", a.numbers.steps, b.numbers.steps);
    writer.add_count("unbalanced_steps", "unbalanced steps", a.numbers.unbalanced_steps, b.numbers.unbalanced_steps);
    writer.add_count("solves", "linear solves", solves(a), solves(b));
    writer.add_count("time_steps", "time steps", time_steps(a), time_steps(b));
    writer.add("elapsed_s", "time", "s", 1.0, elapsed(a), elapsed(b));
}

void note_peak(const FinishedRun& run, std::vector<std::string>& notes) {
    if (!run.platen_stage) return;
    if (!run.numbers.peak_stress) {
        notes.push_back(run.name + " has no balanced equilibrium, so no peak");
    } else if (run.numbers.net_locked) {
        notes.push_back(run.name + " has no peak: its net locked, its largest stress before is compared");
    } else if (is_short_of_peak(run)) {
        notes.push_back(run.name + " was stopped before its stress fell: it has no peak yet to compare");
    } else if (!is_strength(run.numbers)) {
        notes.push_back(run.name + " has no peak: its stress was not yet falling, its largest one is compared");
    }
}

void note_bodies(const FinishedRun& a, const FinishedRun& b, std::vector<std::string>& notes) {
    if (!a.model || !b.model) return;
    const BlockSystem& first = a.model->system;
    const BlockSystem& second = b.model->system;
    if (first.n_blocks() == second.n_blocks() && first.n_interfaces() == second.n_interfaces() &&
        first.spacing == second.spacing)
        return;
    notes.push_back(fmt::format("the bodies differ: {} blocks of spacing {:.4g} m and {} of {:.4g} m", first.n_blocks(),
                                first.spacing, second.n_blocks(), second.spacing));
}

std::vector<std::string> notes_of(const FinishedRun& a, const FinishedRun& b) {
    std::vector<std::string> notes = a.notes;
    notes.insert(notes.end(), b.notes.begin(), b.notes.end());
    note_peak(a, notes);
    note_peak(b, notes);
    note_bodies(a, b, notes);
    return notes;
}

bool agree(const std::vector<ComparedQuantity>& quantities) {
    const auto any = [&](Verdict verdict) {
        return std::ranges::find(quantities, verdict, &ComparedQuantity::verdict) != quantities.end();
    };
    return any(Verdict::within) && !any(Verdict::missed);
}

// ---- the picture of cracks ---------------------------------------------------------------------------------------

/// The line of the crack's interface, if that is where the crack is.
DrawnCrack drawn_crack(const FinishedRun& run, const CrackRecord& crack, double side) {
    const Vec2 middle(crack.x, crack.y);
    if (!run.model || crack.interface < 0 || crack.interface >= run.model->system.n_interfaces())
        return {middle, middle, side};
    const BlockSystem& system = run.model->system;
    const Interface& interface = system.interfaces[crack.interface];
    const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
    const Vec2 start = system.origin + edge_start(system, edge);
    const Vec2 end = system.origin + edge_end(system, edge);
    constexpr double displaced = 1e-3; // of the spacing
    if ((0.5 * (start + end) - middle).norm() > displaced * system.spacing) return {middle, middle, side};
    return {start, end, side};
}

std::vector<bool> matched_ones(const std::vector<CrackMatch>& matches, std::size_t CrackMatch::*which, std::size_t n) {
    std::vector<bool> matched(n, false);
    for (const CrackMatch& match : matches) matched[match.*which] = true;
    return matched;
}

std::string by_mode(int n_tension, int n_shear) {
    return fmt::format("{} in tension, {} in shear", n_tension, n_shear);
}

/// Puts the cracks of a run into its own group and that of matched ones; returns how many of the latter are tensile.
int divide_cracks(const FinishedRun& run, const std::vector<bool>& matched, double side, CrackGroup& own,
                  CrackGroup& common) {
    int n_tension = 0, n_shear = 0, n_matched_tension = 0;
    const auto& cracks = *run.cracks;
    for (std::size_t i = 0; i < cracks.size(); ++i) {
        const bool tension = cracks[i].mode == CrackMode::tension;
        if (matched[i]) {
            n_matched_tension += tension ? 1 : 0;
        } else {
            ++(tension ? n_tension : n_shear);
        }
        if (has_place(cracks[i])) (matched[i] ? common : own).cracks.push_back(drawn_crack(run, cracks[i], side));
    }
    own.label = fmt::format("only {}: {}", run.name, n_tension + n_shear);
    own.note = by_mode(n_tension, n_shear);
    return n_matched_tension;
}

} // namespace

std::vector<CrackMatch> match_cracks(const std::vector<CrackRecord>& a, const std::vector<CrackRecord>& b,
                                     double reach) {
    auto pairs = pairs_within(a, b, (1.0 + rounding) * reach);
    std::ranges::sort(pairs, [](const CrackMatch& p, const CrackMatch& q) {
        return std::tuple(p.distance, p.a, p.b) < std::tuple(q.distance, q.a, q.b);
    });
    std::vector<bool> used_a(a.size(), false), used_b(b.size(), false);
    std::vector<CrackMatch> matches;
    for (const CrackMatch& pair : pairs) {
        if (used_a[pair.a] || used_b[pair.b]) continue;
        used_a[pair.a] = used_b[pair.b] = true;
        matches.push_back(pair);
    }
    std::ranges::sort(matches, {}, &CrackMatch::a);
    return matches;
}

namespace {

double just_beyond(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }

} // namespace

std::vector<Vec2> growing_curve(const std::vector<StepRecord>& rows) {
    std::vector<Vec2> curve;
    const auto last =
        std::find_if(rows.rbegin(), rows.rend(), [](const StepRecord& row) { return row.axial_strain != 0.0; });
    const double sense = last != rows.rend() && last->axial_strain < 0.0 ? -1.0 : 1.0; // of the platen
    double before = std::numeric_limits<double>::quiet_NaN();                          // strain of the row before
    for (const StepRecord& row : rows) {
        const Vec2 point = sense * Vec2(row.axial_strain, row.differential_stress);
        if (!row.balanced || !point.allFinite()) continue;
        const bool drops = point.x() == std::exchange(before, point.x()); // as where bonds break
        if (curve.empty() || point.x() > curve.back().x()) {
            curve.push_back(point);
        } else if (drops && point.x() == curve.back().x()) {
            curve.emplace_back(just_beyond(point.x()), point.y());
        } else if (drops && just_beyond(point.x()) == curve.back().x()) {
            curve.back().y() = point.y();
        }
    }
    return curve;
}

std::optional<CurveDifference> curve_difference(const std::vector<StepRecord>& a, const std::vector<StepRecord>& b,
                                                double end, double scale) {
    const auto curve_a = growing_curve(a);
    const auto curve_b = growing_curve(b);
    if (curve_a.empty() || curve_b.empty() || !(scale > 0.0)) return std::nullopt;
    const double from = std::max(curve_a.front().x(), curve_b.front().x());
    const double to = std::min({end, curve_a.back().x(), curve_b.back().x()});
    if (!(to > from)) return std::nullopt;
    CurveDifference result;
    for (int i = 0; i < n_curve_points; ++i) {
        const double share = static_cast<double>(i) / (n_curve_points - 1);
        const double strain = from + share * (to - from);
        const double difference = std::abs(stress_at(curve_b, strain) - stress_at(curve_a, strain)) / scale;
        result.largest = std::max(result.largest, difference);
        result.mean += difference / n_curve_points;
    }
    result.end = to;
    return result;
}

std::optional<double> curve_distance(const std::vector<Vec2>& reference, const std::vector<Vec2>& curve) {
    if (reference.empty() || curve.empty()) return std::nullopt;
    const double from = std::max(reference.front().x(), curve.front().x());
    const double to = std::min(reference.back().x(), curve.back().x());
    if (!(to > from)) return std::nullopt;
    double distance = 0.0, norm = 0.0;
    for (int i = 0; i < n_curve_points; ++i) {
        const double strain = std::lerp(from, to, static_cast<double>(i) / (n_curve_points - 1));
        const double weight = i == 0 || i == n_curve_points - 1 ? 0.5 : 1.0; // trapezoids
        const double stress = stress_at(reference, strain);
        const double difference = stress_at(curve, strain) - stress;
        distance += weight * difference * difference;
        norm += weight * stress * stress;
    }
    return norm > 0.0 ? std::optional(std::sqrt(distance / norm)) : std::nullopt;
}

Comparison compare_runs(const FinishedRun& a, const FinishedRun& b, double tolerance) {
    Comparison comparison;
    ComparisonTable& table = comparison.table;
    table.a = compared_run(a);
    table.b = compared_run(b);
    table.tolerance = tolerance;
    table.notes = notes_of(a, b);
    if (a.cracks && b.cracks) table.matching_distance = matching_distance(a, b);
    if (table.matching_distance) comparison.matches = match_cracks(*a.cracks, *b.cracks, *table.matching_distance);
    const auto curves = difference_of_curves(a, b);
    if (curves) table.curve_end = curves->end;
    TableWriter writer(table);
    add_mechanics(a, b, writer);
    const auto factor_a = a.summary ? a.summary->results.factor_of_safety : std::nullopt;
    const auto factor_b = b.summary ? b.summary->results.factor_of_safety : std::nullopt;
    if (factor_a || factor_b)
        writer.judge(writer.add("factor_of_safety", "factor of safety", "", 1.0, factor_a, factor_b));
    else if (!a.platen_stage && !b.platen_stage)
        add_load(a, b, writer);
    add_cracks(a, b, comparison, writer);
    add_curves(curves, writer);
    add_costs(a, b, writer);
    table.agree = agree(table.quantities);
    return comparison;
}

CracksPlot cracks_plot(const FinishedRun& a, const FinishedRun& b, const std::vector<CrackMatch>& matches) {
    CrackGroup only_a{"", "", series_colour(0), {}};
    CrackGroup only_b{"", "", series_colour(1), {}};
    CrackGroup common{fmt::format("in both: {}", matches.size()), "", matched_colour, {}};
    int n_tension = 0;
    if (a.cracks)
        n_tension = divide_cracks(a, matched_ones(matches, &CrackMatch::a, a.cracks->size()), -1.0, only_a, common);
    if (b.cracks) (void)divide_cracks(b, matched_ones(matches, &CrackMatch::b, b.cracks->size()), 1.0, only_b, common);
    common.note = by_mode(n_tension, static_cast<int>(matches.size()) - n_tension);
    CracksPlot plot;
    plot.title = fmt::format("Cracks of {} and {}", a.name, b.name);
    plot.heading = "before loading";
    plot.groups = {std::move(common), std::move(only_a), std::move(only_b)};
    if (const auto distance = matching_distance(a, b))
        plot.notes.push_back(fmt::format("in both: of one mode, within {:.4g} m", *distance));
    return plot;
}

void require_no_other_comparison(const std::filesystem::path& directory) {
    const std::filesystem::path earlier = directory / "compare.json";
    std::error_code error;
    const bool is_ours = std::filesystem::is_regular_file(earlier, error) && is_comparison_json(read_file(earlier));
    if (is_ours) return;
    std::vector<std::string> names(pictures_and_text.begin(), pictures_and_text.end());
    names.emplace_back("compare.json");
    require_no_foreign_file(directory, names, "a comparison", "-o names another directory");
}

void write_comparison(const std::filesystem::path& directory, const FinishedRun& a, const FinishedRun& b,
                      Comparison& comparison) {
    make_directory(directory);
    for (const char* name : pictures_and_text) remove_file(directory / name);
    ComparisonTable& table = comparison.table;
    const Model* const model = a.model ? &*a.model : b.model ? &*b.model : nullptr;
    const bool has_curve = a.platen_stage || b.platen_stage;
    if (has_curve) table.pictures = {"curves.png"};
    if (model != nullptr) table.pictures.emplace_back("cracks.png");
    write_file(directory / "compare.json", comparison_json(table)); // first: it says whose the others are
    if (has_curve) {
        CurvePlot curves = stress_strain_plot(fmt::format("{} and {}", a.name, b.name),
                                              {{a.name, a.history, a.equilibria, a.platen_stage.value_or(0)},
                                               {b.name, b.history, b.equilibria, b.platen_stage.value_or(0)}});
        curves.curves.back().dashed = true;
        for (const char* name : {"curves.png", "curves.svg"}) write_curves(directory / name, curves);
    }
    if (model != nullptr) {
        const CracksPlot cracks = cracks_plot(a, b, comparison.matches);
        write_cracks(directory / "cracks.png", model->system, cracks);
        if (model->system.n_blocks() <= most_blocks_in_svg)
            write_cracks(directory / "cracks.svg", model->system, cracks);
    }
    write_file(directory / "compare.md", comparison_markdown(table));
}

} // namespace kluft
