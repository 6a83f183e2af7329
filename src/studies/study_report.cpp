#include "kluft/studies/study_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/digest.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/shell_line.hpp"
#include "kluft/core/units.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/report/report_document.hpp"
#include "kluft/studies/ensemble.hpp"
#include "kluft/studies/study_analysis.hpp"
#include "kluft/studies/study_pictures.hpp"
#include "kluft/studies/study_results.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

constexpr double precision_wanted = 0.01; // of the mean of an ensemble
constexpr const char* unknown = "-";
constexpr std::string_view picture_prefix = "study-";

std::string percent_text(double fraction) { return fmt::format("{:.3g} %", percent * fraction); }

/// With its sign if it has one; nothing is written of what is round-off.
std::string error_text(double error, bool has_sign) {
    constexpr double round_off = 1e-10;
    if (std::abs(error) < round_off) return "0 %";
    return has_sign ? fmt::format("{:+.3g} %", percent * error) : percent_text(error);
}

std::string value_text(const StudyMeasure& measure, double value) {
    const QuantityUnit unit = quantity_unit(measure.name);
    return fmt::format("{:.5g}{}{}", value / unit.size, unit.name.empty() ? "" : " ", unit.name);
}

std::string constant_text(const Convergence& result) {
    constexpr double round_off = 1e-10;
    return result.scatter <= round_off ? "no change" : fmt::format("constant to {:.2g} %", percent * result.scatter);
}

std::string seconds_text(double seconds) { return fmt::format("{:.3g} s", seconds); }

std::string counted(std::size_t n, const std::string& thing) {
    return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s");
}

std::string status_text(CaseStatus status) {
    std::string name = case_status_name(status);
    std::ranges::replace(name, '_', ' ');
    return name;
}

/// "kept-letters-only" for the name of a file; a long one is cut and told apart by digits.
std::string file_word(const std::string& text) {
    constexpr std::size_t longest = 100;
    constexpr std::size_t kept = 60;
    std::string word;
    for (const char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        word += plain || c == '_' ? c : '-';
    }
    return word.size() <= longest ? word : told_apart(word.substr(0, kept), text);
}

/// A text in which every number is the same.
std::string without_digits(const std::string& text) {
    std::string words;
    for (const char c : text)
        if ((c < '0' || c > '9') && c != '.' && c != '-') words += c;
    return words;
}

std::string on_words(const StudyMeasure& measure) {
    return measure.is_curve ? std::string("in the whole curve") : "on " + measure.name;
}

/// Done members' values of a measure.
std::vector<double> member_values(const StudyTable& table, const StudyGroup& group, const StudyMeasure& measure) {
    std::vector<double> values;
    for (const std::size_t i : group.cases)
        if (table.cases[i].status == CaseStatus::done && measure.values[i]) values.push_back(*measure.values[i]);
    return values;
}

/// The report while it grows.
class ReportBuilder {
public:
    ReportBuilder(const StudyTable& table, fs::path directory, const StudyReportOptions& options)
        : table_(table), directory_(std::move(directory)), options_(options), measures_(study_measures(table)),
          groups_(study_groups(table)), series_(study_series(table, groups_)),
          other_models_(other_model_marks(table, groups_)) {
        for (std::size_t g = 0; g < groups_.size(); ++g) labels_.push_back(group_label(table, groups_, g));
        for (const StudyCase& each : table.cases) {
            runs_.push_back(read_case_run(table.directory / "cases" / each.name));
            unbalanced_.push_back(runs_.back() && runs_.back()->unbalanced_steps > 0);
        }
        choose_measure();
    }

    ReportDocument build() {
        add_head();
        add_convergence();
        add_work_precision();
        add_replicas();
        add_curves();
        add_cases();
        add_model_choices();
        add_recommendation();
        return std::move(document_);
    }

private:
    void add(ReportPart part) { document_.push_back(std::move(part)); }

    void choose_measure();
    void add_picture(const std::string& name, const CurvePlot& plot);
    void add_head();
    [[nodiscard]] std::optional<ReportAnswer> found_answer() const;
    [[nodiscard]] std::optional<ReportAnswer> answer_of_replicas() const;
    [[nodiscard]] std::string set_words(std::size_t group) const;
    [[nodiscard]] std::string settings_and_model(std::size_t group) const;
    void add_convergence();
    void add_work_precision();
    void add_replicas();
    void add_curves();
    void add_cases();
    void add_failures();
    void add_warnings();
    void add_model_choices();
    void add_recommendation();
    void add_band(const StudyGroup& group, const std::string& label);
    [[nodiscard]] std::string sentence(const Advice& advice, const StudyMeasure& measure) const;
    [[nodiscard]] std::string reference_doubt(const StudyMeasure& measure) const;
    [[nodiscard]] std::vector<bool> same_model() const;
    [[nodiscard]] std::string full_reference_words() const;
    [[nodiscard]] std::vector<std::string> varied_items() const;
    [[nodiscard]] bool has_own_text(std::size_t parameter) const;
    [[nodiscard]] std::string setting_of(const StudySeries& series, const SeriesLevel& level) const;
    [[nodiscard]] std::string left_out_text(const StudySeries& series, const StudyMeasure& measure,
                                            const SeriesValues& found) const;
    [[nodiscard]] ReportTable chosen_convergence() const;
    [[nodiscard]] ReportTable other_convergence() const;
    [[nodiscard]] bool has_replicas() const;
    [[nodiscard]] std::vector<std::string> named_constants() const;
    void add_names();
    [[nodiscard]] std::optional<double> solves_of(std::size_t group) const;
    [[nodiscard]] std::string cost_text(std::size_t group, double cpu_s) const;
    [[nodiscard]] bool is_own(std::size_t group) const;
    [[nodiscard]] std::string own_sentence(const StudyMeasure& measure) const;
    [[nodiscard]] std::vector<std::string> accuracy_items(const StudyMeasure& measure) const;
    [[nodiscard]] const std::string& label_of(std::size_t group) const { return labels_[group]; }
    /// The quantity that is recommended for, and the curve.
    [[nodiscard]] std::vector<const StudyMeasure*> judged_measures() const;

    const StudyTable& table_;
    fs::path directory_;
    const StudyReportOptions& options_;
    std::vector<StudyMeasure> measures_;
    std::vector<StudyGroup> groups_;
    std::vector<StudySeries> series_;
    std::vector<bool> other_models_;           ///< per group
    std::vector<std::string> labels_;          ///< per group
    std::vector<std::optional<CaseRun>> runs_; ///< per case
    std::vector<bool> unbalanced_;             ///< per case
    std::optional<std::size_t> chosen_;        ///< index of the measure that is recommended for
    ReportDocument document_;
};

void ReportBuilder::choose_measure() {
    if (!options_.quantity.empty() && options_.quantity != "curve" &&
        std::ranges::find(table_.quantities, options_.quantity) == table_.quantities.end())
        throw InputError("study report: expected a quantity of the study, found '" + options_.quantity + "'" +
                         suggestion(options_.quantity, table_.quantities));
    for (std::size_t i = 0; i < measures_.size() && !chosen_; ++i)
        if (options_.quantity.empty() || measures_[i].name == options_.quantity) chosen_ = i;
}

std::vector<const StudyMeasure*> ReportBuilder::judged_measures() const {
    std::vector<const StudyMeasure*> judged;
    for (std::size_t i = 0; i < measures_.size(); ++i) {
        const bool has_errors = std::ranges::any_of(
            measures_[i].errors, [](const std::optional<double>& error) { return error.has_value(); });
        if (has_errors && (chosen_ == i || measures_[i].is_curve)) judged.push_back(&measures_[i]);
    }
    return judged;
}

void ReportBuilder::add_picture(const std::string& name, const CurvePlot& plot) {
    const std::string stem = std::string(picture_prefix) + file_word(name);
    const std::string svg = draw_curves(plot, PictureFormat::svg);
    write_file(directory_ / (stem + ".svg"), svg);
    write_file(directory_ / (stem + ".png"), draw_curves(plot, PictureFormat::png));
    add(ReportPicture{stem + ".png", plot.title, svg});
}

void ReportBuilder::add_head() {
    add(ReportHeading{1, table_.title.empty() ? "Study" : table_.title});
    std::map<CaseStatus, std::size_t> counts;
    double cpu = 0.0;
    for (const StudyCase& each : table_.cases) {
        ++counts[each.status];
        cpu += each.cpu_s.value_or(0.0);
    }
    std::vector<std::string> parts;
    for (const auto& [status, count] : counts) parts.push_back(fmt::format("{} {}", count, status_text(status)));
    std::vector<std::string> items{fmt::format("{}: {}; {} of CPU time in all.", counted(table_.cases.size(), "case"),
                                               listed(parts), seconds_text(cpu))};
    if (!table_.reference_name.empty() && table_.reference_name != "none")
        items.push_back("Errors are those against " + full_reference_words() + ".");
    const auto n_unbalanced = std::ranges::count(unbalanced_, true);
    if (n_unbalanced > 0)
        items.push_back(fmt::format("{} unbalanced load steps: marked in the plots, and never recommended.",
                                    counted(static_cast<std::size_t>(n_unbalanced), "case") +
                                        (n_unbalanced == 1 ? " has" : " have")));
    const auto references = reference_marks(table_);
    for (std::size_t i = 0; i < references.size(); ++i)
        if (references[i] && unbalanced_[i])
            items.push_back(
                fmt::format("{} is a reference and has unbalanced load steps: what is measured against it is "
                            "known no better than it is.",
                            table_.cases[i].name));
    const auto n_warned = std::ranges::count_if(runs_, [](const auto& run) { return run && !run->warnings.empty(); });
    if (n_warned > 0)
        items.push_back(
            fmt::format("{} warnings, which stand below the table of the cases.",
                        counted(static_cast<std::size_t>(n_warned), "case") + (n_warned == 1 ? " has" : " have")));
    if (auto answer = found_answer()) add(std::move(*answer));
    add(ReportList{std::move(items)});
    auto varied = varied_items();
    if (varied.empty()) return;
    add(ReportParagraph{"Varied:"});
    add(ReportList{std::move(varied)});
}

/// How a group computes, as the command line takes it; its model is the user's.
std::string ReportBuilder::set_words(std::size_t group) const {
    const StudyCase& first = table_.cases[groups_[group].cases.front()];
    std::vector<std::string> words;
    for (std::size_t p = 0; p < table_.parameters.size(); ++p)
        if (!first.settings[p].empty() && !makes_the_model(table_, p))
            words.insert(words.end(), {"--set", table_.parameters[p] + "=" + first.settings[p]});
    return shell_line(words);
}

/// The mean of the first ensemble, where nothing else was varied.
std::optional<ReportAnswer> ReportBuilder::answer_of_replicas() const {
    if (groups_.size() != 1 || judged_measures().empty()) return std::nullopt;
    const StudyMeasure& measure = *judged_measures().front();
    const auto values = member_values(table_, groups_.front(), measure);
    if (values.size() < 2) return std::nullopt;
    const EnsembleStatistics found = ensemble_statistics(values);
    return ReportAnswer{measure.name,
                        value_text(measure, found.mean) + " \u00b1 " + value_text(measure, *found.half_width),
                        fmt::format("The mean of {} and its 95 % confidence; the standard deviation is {}.",
                                    counted(values.size(), "replica"), value_text(measure, found.deviation))};
}

/// What the study comes to: the mean of replicas, or the cheapest settings that hold the smallest bound that any hold.
std::optional<ReportAnswer> ReportBuilder::found_answer() const {
    if (auto answer = answer_of_replicas()) return answer;
    const auto judged = judged_measures();
    if (judged.empty() || table_.reference_name.empty() || table_.reference_name == "none") return std::nullopt;
    const StudyMeasure& measure = *judged.front();
    std::optional<Advice> best;
    for (const Advice& advice : cheapest_settings(table_, groups_, measure, unbalanced_, options_.bounds))
        if (advice.group && (!best || advice.bound < best->bound)) best = advice;
    if (!best)
        return ReportAnswer{"Recommendation", "none", "No settings hold a bound with a finer case that confirms them.",
                            "", false};
    const std::string model = model_of_group(table_, groups_, *best->group);
    if (best->is_unconfirmed)
        return ReportAnswer{
            "Recommendation", advised_settings(table_, groups_, *best->group) + ", not confirmed",
            fmt::format(
                "They are the reference itself, which no finer case of this study confirms: its error is not known. No "
                "cheaper settings hold an error of {:.3g} % {} with a finer case that confirms them. A case costs {}.",
                percent * best->bound, on_words(measure), cost_text(*best->group, best->cpu_s)),
            set_words(*best->group), false};
    return ReportAnswer{
        "Recommendation", advised_settings(table_, groups_, *best->group),
        fmt::format(
            "The cheapest settings with an error of at most {:.3g} % {}: it is {:.2g} %, and a case costs {}.{}",
            percent * best->bound, on_words(measure), percent * best->error, cost_text(*best->group, best->cpu_s),
            model.empty() ? "" : fmt::format(" Found with {}.", model)),
        set_words(*best->group)};
}

std::string ReportBuilder::settings_and_model(std::size_t group) const {
    const std::string model = model_of_group(table_, groups_, group);
    return advised_settings(table_, groups_, group) + (model.empty() ? "" : " with " + model);
}

std::string ReportBuilder::full_reference_words() const {
    if (!table_.reference || table_.own_settings.empty()) return table_.reference_name;
    for (std::size_t g = 0; g < groups_.size(); ++g)
        if (std::ranges::find(groups_[g].cases, *table_.reference) != groups_[g].cases.end())
            return fmt::format("{} ({})", reference_words(table_), settings_and_model(g));
    return table_.reference_name;
}

/// "cracks.update: all, event (the scene: event)"; what all cases have as the scene is left out.
std::vector<std::string> ReportBuilder::varied_items() const {
    std::vector<std::string> items;
    for (std::size_t p = 0; p < table_.parameters.size(); ++p) {
        std::vector<std::string> values;
        for (const StudyCase& each : table_.cases)
            if (!each.settings[p].empty() && std::ranges::find(values, each.settings[p]) == values.end())
                values.push_back(each.settings[p]);
        if (values.empty() || (values.size() == 1 && is_own_setting(table_, p, values.front()))) continue;
        constexpr std::size_t most_values = 10;
        const std::size_t n = values.size();
        if (n > most_values) {
            values = {values[0], values[1], values[2], "...", values.back()};
            values.back() += fmt::format(" ({} values)", n);
        }
        items.push_back(table_.parameters[p] + ": " + listed(values));
        if (has_own_text(p)) items.back() += fmt::format(" (the scene: {})", table_.own_settings[p]);
    }
    return items;
}

/// Whether the scene says a number or a word there, or has a default.
bool ReportBuilder::has_own_text(std::size_t parameter) const {
    if (table_.own_settings.empty()) return false;
    const std::string& own = table_.own_settings[parameter];
    return !own.empty() && own != "[...]" && own != "{...}";
}

/// What a series says of a measure, in words.
std::string verdict_text(const StudyMeasure& measure, const Convergence& result, std::size_t n_values) {
    const std::string scatter = percent_text(result.scatter);
    if (n_values < 2) return "one value only";
    if (is_after_peak(measure.name)) return fmt::format("after the peak: no order; scatter {}", scatter);
    switch (result.kind) {
    case ConvergenceKind::too_few:
        return fmt::format("two values: {} apart", scatter);
    case ConvergenceKind::constant:
        return constant_text(result);
    case ConvergenceKind::monotone:
        return fmt::format("order {:.2g}, limit {} \u00b1 {}", *result.order, value_text(measure, *result.limit),
                           percent_text(*result.uncertainty));
    case ConvergenceKind::unsettled:
        return fmt::format("one way, but no order: finest value \u00b1 {}", percent_text(*result.uncertainty));
    case ConvergenceKind::scattered:
        return fmt::format("no order: scatter {}", scatter);
    }
    return "";
}

/// The same for a cell of a table.
std::string short_verdict(const StudyMeasure& measure, const Convergence& result, std::size_t n_values) {
    if (n_values < 2) return unknown;
    if (!is_after_peak(measure.name)) {
        if (result.kind == ConvergenceKind::constant) return constant_text(result);
        if (result.kind == ConvergenceKind::monotone)
            return fmt::format("order {:.2g}, \u00b1 {}", *result.order, percent_text(*result.uncertainty));
        if (result.kind == ConvergenceKind::unsettled) return "\u00b1 " + percent_text(*result.uncertainty);
    }
    return "scatter " + percent_text(result.scatter);
}

std::string ReportBuilder::setting_of(const StudySeries& series, const SeriesLevel& level) const {
    return groups_[level.group].settings[series.parameter];
}

/// "; but +140 % at 25" of coarser values than the verdict is of that differ from the finest by more than those do; "" without any.
std::string ReportBuilder::left_out_text(const StudySeries& series, const StudyMeasure& measure,
                                         const SeriesValues& found) const {
    const double finest = found.values.empty() ? 0.0 : found.values.back();
    const auto distance = [&](double value) { return std::abs(value - finest); };
    const std::size_t n_left_out = found.values.size() - std::min(found.values.size(), most_judged);
    double among_judged = noise_of_values * std::abs(finest);
    for (std::size_t i = n_left_out; i < found.values.size(); ++i)
        among_judged = std::max(among_judged, distance(found.values[i]));
    std::string text;
    for (std::size_t i = 0; i < n_left_out; ++i) {
        const double value = found.values[i];
        if (distance(value) <= among_judged) continue;
        text += fmt::format("{} {} at {}", text.empty() ? "; but" : ",",
                            finest != 0.0 ? error_text((value - finest) / std::abs(finest), true)
                                          : value_text(measure, value),
                            groups_[found.groups[i]].settings[series.parameter]);
    }
    return text;
}

/// The chosen quantity's series in full.
ReportTable ReportBuilder::chosen_convergence() const {
    ReportTable rows{{"refined", "with", "from", "to", "finest value", "verdict"}, {}, {}, 6};
    if (!chosen_ || measures_[*chosen_].is_curve) return rows;
    const StudyMeasure& measure = measures_[*chosen_];
    for (const StudySeries& series : series_) {
        const SeriesValues found = series_values(table_, groups_, series, measure);
        if (found.values.empty()) continue;
        const Convergence result = convergence(found.sizes, found.values, noise_of_values);
        rows.rows.push_back(
            {table_.parameters[series.parameter], series_label(table_, groups_, series_, series),
             setting_of(series, series.levels.front()), setting_of(series, series.levels.back()),
             value_text(measure, found.values.back()),
             verdict_text(measure, result, found.values.size()) + left_out_text(series, measure, found)});
    }
    return rows;
}

/// The other quantities side by side.
ReportTable ReportBuilder::other_convergence() const {
    ReportTable rows{{"refined", "with"}, {}, {}, 0};
    std::vector<const StudyMeasure*> others;
    for (std::size_t i = 0; i < measures_.size(); ++i)
        if (chosen_ != i && !measures_[i].is_curve) others.push_back(&measures_[i]);
    for (const StudyMeasure* const measure : others) rows.head.push_back(measure->name);
    rows.n_words = rows.head.size();
    if (others.empty()) return rows;
    for (const StudySeries& series : series_) {
        std::vector<std::string> row{table_.parameters[series.parameter],
                                     series_label(table_, groups_, series_, series)};
        for (const StudyMeasure* const measure : others) {
            const SeriesValues found = series_values(table_, groups_, series, *measure);
            const Convergence result = convergence(found.sizes, found.values, noise_of_values);
            row.push_back(short_verdict(*measure, result, found.values.size()) +
                          left_out_text(series, *measure, found));
        }
        const bool any =
            std::any_of(row.begin() + 2, row.end(), [](const std::string& cell) { return cell != unknown; });
        if (any) rows.rows.push_back(std::move(row));
    }
    return rows;
}

void ReportBuilder::add_convergence() {
    ReportTable chosen = chosen_convergence();
    ReportTable others = other_convergence();
    if (chosen.rows.empty() && others.rows.empty()) return;
    add(ReportHeading{2, "Convergence"});
    add(ReportParagraph{
        fmt::format("Richardson's extrapolation of the last four values of each series (three where there are no "
                    "more): the observed order p of q = q0 + C h^p, the limit q0, and behind \u00b1 the uncertainty "
                    "of the finest value against it (grid convergence index). Where values go up and down there "
                    "is no order and no limit; the scatter is the range of these values over their mean. Changes "
                    "up to {} are called constant. Coarser values are named where they differ from the finest one "
                    "by more than the last four do.",
                    percent_text(noise_of_values))});
    if (!chosen.rows.empty()) {
        add(ReportParagraph{measures_[*chosen_].name + ":"});
        add(std::move(chosen));
    }
    if (!others.rows.empty()) {
        add(ReportParagraph{"Other quantities, behind \u00b1 the uncertainty of the finest value:"});
        add(std::move(others));
    }
    for (const StudyMeasure& measure : measures_)
        if (is_after_peak(measure.name))
            add(ReportParagraph{measure.name +
                                " comes after the peak, where runs part from each other: what single runs say of it "
                                "does not converge. Only its mean over replicas means something, with its "
                                "confidence."});
    if (!chosen_ || measures_[*chosen_].is_curve) return;
    std::map<std::size_t, std::vector<StudySeries>> by_parameter;
    for (const StudySeries& series : series_) {
        if (other_models_[series.levels.front().group]) continue;
        by_parameter[series.parameter].push_back(series);
    }
    for (const auto& [parameter, series] : by_parameter)
        add_picture("convergence-" + table_.parameters[parameter],
                    convergence_plot(table_, groups_, series, measures_[*chosen_]));
}

std::vector<bool> ReportBuilder::same_model() const {
    std::vector<bool> same(table_.cases.size(), false);
    for (std::size_t g = 0; g < groups_.size(); ++g)
        for (const std::size_t i : groups_[g].cases) same[i] = !other_models_[g];
    return same;
}

void ReportBuilder::add_work_precision() {
    bool has_heading = false;
    for (const StudyMeasure* const measure : judged_measures()) {
        const auto points = work_precision(table_, *measure, same_model(), unbalanced_);
        if (points.size() < 2) continue;
        if (!std::exchange(has_heading, true)) {
            add(ReportHeading{2, "Error against time"});
            add(ReportParagraph{
                "Each point is a case that ended as it should. The dashed line joins those that no "
                "other case beats in both cost and error; a single point of it may be a lucky hit, and CPU "
                "times of short runs vary from one to the next."});
        }
        add_picture("work-" + measure->name, work_precision_plot(table_, groups_, series_, *measure, points));
    }
}

void ReportBuilder::add_band(const StudyGroup& group, const std::string& label) {
    std::vector<CaseRun> runs;
    std::vector<std::vector<Vec2>> curves;
    for (const std::size_t i : group.cases) {
        if (table_.cases[i].status != CaseStatus::done || !runs_[i] || runs_[i]->curve.size() < 2) continue;
        runs.push_back(*runs_[i]);
        curves.push_back(runs_[i]->curve);
    }
    constexpr int n_points = 201;
    const CurveBand band = curve_band(curves, n_points);
    if (band.x.empty()) return;
    add_picture("band-" + label, band_plot(groups_.size() == 1 ? fmt::format("{} replicas", runs.size())
                                                               : fmt::format("{} replicas, {}", runs.size(), label),
                                           runs, band));
    const auto top = std::ranges::max_element(band.mean);
    const auto peak = static_cast<std::size_t>(top - band.mean.begin());
    if (peak + 1 == band.mean.size()) return;
    const auto n = static_cast<double>(curves.size());
    const double to_confidence = student_quantile(static_cast<int>(curves.size()) - 1, 0.95) / std::sqrt(n);
    const auto with_spread = [&](double mean, double deviation) {
        const double share = percent * deviation / std::max(std::abs(mean), 1e-300);
        return fmt::format("{:.4g} MPa (standard deviation {:.2g} %, 95 % confidence of the mean \u00b1 {:.2g} %)",
                           mean, share, to_confidence * share);
    };
    add(ReportParagraph{fmt::format(
        "The mean curve of the differential stress has its highest point, {}, at {:.3g} % strain; at the end of the "
        "common range, {:.3g} %, it is {}. Values after the peak of a single run mean little: they are given with this "
        "band only.",
        with_spread(*top, band.deviation[peak]), band.x[peak], band.x.back(),
        with_spread(band.mean.back(), band.deviation.back()))});
}

void ReportBuilder::add_replicas() {
    ReportTable rows{
        {"settings", "quantity", "members", "mean", "standard deviation", "95 % confidence", "members for \u00b11 %"},
        {},
        {},
        2};
    std::vector<std::size_t> ensembles;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        for (const StudyMeasure& measure : measures_) {
            const auto values = member_values(table_, groups_[g], measure);
            if (values.size() < 2) continue;
            const EnsembleStatistics found = ensemble_statistics(values);
            const double deviation = found.mean != 0.0 ? found.deviation / std::abs(found.mean) : 0.0;
            rows.rows.push_back({label_of(g), measure.name, fmt::format("{}", found.n), value_text(measure, found.mean),
                                 percent_text(deviation),
                                 "\u00b1 " + percent_text(*found.half_width / std::max(std::abs(found.mean), 1e-300)),
                                 fmt::format("{}", members_needed(deviation, precision_wanted))});
        }
        if (groups_[g].cases.size() > 1) ensembles.push_back(g);
    }
    if (rows.rows.empty()) return;
    add(ReportHeading{2, "Replicas"});
    add(ReportParagraph{"Copies that differ in nothing but small perturbations. The confidence is that of the mean "
                        "(Student's t); the last column says how many members would bring it to \u00b11 %, if the "
                        "standard deviation stays as it is."});
    add(std::move(rows));
    constexpr std::size_t most_bands = 6;
    if (ensembles.size() > most_bands) {
        add(ReportParagraph{fmt::format("Bands are drawn for {} of {} ensembles, the last ones of the table.",
                                        most_bands, ensembles.size())});
        ensembles.erase(ensembles.begin(), ensembles.end() - most_bands);
    }
    for (const std::size_t g : ensembles) add_band(groups_[g], label_of(g));
}

void ReportBuilder::add_curves() {
    constexpr std::size_t most_pictures = 8;
    std::size_t n_pictures = 0;
    for (const StudySeries& series : series_) {
        std::vector<CaseRun> runs;
        std::vector<std::string> labels;
        for (const SeriesLevel& level : series.levels) {
            const std::size_t first = groups_[level.group].cases.front();
            if (!runs_[first] || runs_[first]->points.empty()) continue;
            runs.push_back(*runs_[first]);
            labels.push_back(groups_[level.group].settings[series.parameter]);
        }
        if (runs.size() < 2 || n_pictures == most_pictures) continue;
        if (n_pictures++ == 0) {
            add(ReportHeading{2, "Curves"});
            add(ReportParagraph{"Up to the peak the curves of a series go to one; what a single run does after its "
                                "peak is one of many ways that are equally likely. They show the differential stress; "
                                "peak_stress is the largest axial stress, with the lateral one in it."});
        }
        const std::string with = series_label(table_, groups_, series_, series);
        const std::string& key = table_.parameters[series.parameter];
        add_picture(fmt::format("curves-{}-{}", key, with),
                    curves_plot(fmt::format("{}, by {}", with, key), runs, labels));
    }
}

bool ReportBuilder::has_replicas() const {
    return std::ranges::any_of(groups_, [](const StudyGroup& group) { return group.cases.size() > 1; });
}

/// What the names of cases do not say: "reference: 800 steps of stage 1", of each variant what all its cases have and
/// the scene has not.
std::vector<std::string> ReportBuilder::named_constants() const {
    std::vector<std::string> variants;
    for (const StudyCase& each : table_.cases)
        if (!each.variant.empty() && std::ranges::find(variants, each.variant) == variants.end())
            variants.push_back(each.variant);
    std::vector<std::string> items;
    for (const std::string& variant : variants) {
        std::vector<std::string> words;
        for (std::size_t p = 0; p < table_.parameters.size(); ++p) {
            std::set<std::string> values;
            for (const StudyCase& each : table_.cases)
                if (each.variant == variant) values.insert(each.settings[p]);
            if (values.size() == 1 && !is_own_setting(table_, p, *values.begin()))
                words.push_back(setting_words(table_.parameters[p], *values.begin()));
        }
        if (!words.empty()) items.push_back(variant + ": " + listed(words));
    }
    return items;
}

/// What the names of cases stand for, where the table does not show all settings.
void ReportBuilder::add_names() {
    std::string text = "A case is named after what varies in it; study.csv has all settings.";
    std::vector<std::string> own;
    for (std::size_t p = 0; p < table_.parameters.size(); ++p)
        if (has_own_text(p)) own.push_back(setting_words(table_.parameters[p], table_.own_settings[p]));
    if (!own.empty()) text += " What its name does not say is as in the scene: " + listed(own) + ".";
    auto constants = named_constants();
    if (!constants.empty()) text += " Names of variants stand for:";
    add(ReportParagraph{std::move(text)});
    if (!constants.empty()) add(ReportList{std::move(constants)});
}

void ReportBuilder::add_cases() {
    if (table_.cases.empty()) return;
    constexpr std::size_t most_parameters = 3; // with a column of their own
    const bool with_settings = table_.parameters.size() <= most_parameters;
    ReportTable rows{{"case"}, {}, {}, 0};
    const auto references = reference_marks(table_);
    const bool with_replicas = has_replicas();
    if (with_settings)
        for (const std::string& parameter : table_.parameters) rows.head.push_back(parameter);
    rows.head.emplace_back("status");
    rows.n_words = rows.head.size();
    std::vector<std::pair<const StudyMeasure*, bool>> shown; // whether with its errors
    for (const StudyMeasure& measure : measures_) {
        if (with_replicas && is_after_peak(measure.name)) continue;
        const bool has_errors =
            std::ranges::any_of(measure.errors, [](const auto& error) { return error.has_value(); });
        shown.emplace_back(&measure, has_errors && !is_after_peak(measure.name));
        if (!measure.is_curve) rows.head.push_back(measure.name);
        if (shown.back().second) rows.head.emplace_back(measure.is_curve ? "error of the curve" : "error");
    }
    rows.head.emplace_back("CPU time");
    for (std::size_t i = 0; i < table_.cases.size(); ++i) {
        const StudyCase& each = table_.cases[i];
        std::vector<std::string> row{each.name};
        for (std::size_t p = 0; with_settings && p < table_.parameters.size(); ++p)
            row.push_back(each.settings[p].empty() ? "as the scene" : each.settings[p]);
        row.push_back((references[i] ? std::string("reference") : status_text(each.status)) +
                      (unbalanced_[i] ? ", unbalanced" : ""));
        for (const auto& [measure, with_error] : shown) {
            if (!measure->is_curve)
                row.push_back(measure->values[i] ? value_text(*measure, *measure->values[i]) : unknown);
            if (with_error)
                row.push_back(measure->errors[i] ? error_text(*measure->errors[i], !measure->is_curve) : unknown);
        }
        row.push_back(each.cpu_s ? seconds_text(*each.cpu_s) : unknown);
        if (each.status != CaseStatus::done) rows.marked.push_back(rows.rows.size());
        rows.rows.push_back(std::move(row));
    }
    add(ReportHeading{2, "Cases"});
    if (!with_settings) add_names();
    add(std::move(rows));
    add_failures();
    add_warnings();
}

/// What the runs warned of, so that a number in the table is not taken for what it is not.
void ReportBuilder::add_warnings() {
    struct Kind {
        std::string text; ///< of the first case
        std::vector<std::size_t> cases;
    };
    std::map<std::string, Kind> kinds; // by the text without its numbers
    for (std::size_t i = 0; i < runs_.size(); ++i) {
        if (!runs_[i]) continue;
        for (const std::string& warning : runs_[i]->warnings) {
            Kind& kind = kinds[without_digits(warning)];
            if (kind.cases.empty()) kind.text = warning;
            if (kind.cases.empty() || kind.cases.back() != i) kind.cases.push_back(i);
        }
    }
    if (kinds.empty()) return;
    add(ReportHeading{2, "Warnings"});
    std::vector<std::string> items;
    for (const auto& [words, kind] : kinds) {
        const std::string first = table_.cases[kind.cases.front()].name;
        const bool all = kind.cases.size() == table_.cases.size();
        const std::string others = kind.cases.size() == 1 ? "" : fmt::format(" and {} more", kind.cases.size() - 1);
        items.push_back(fmt::format("{}: {}", all ? "all cases" : first + others, kind.text));
    }
    add(ReportList{std::move(items)});
}

void ReportBuilder::add_failures() {
    ReportTable rows{{"case", "how it ended", "why"}, {}, {}, 3};
    for (const StudyCase& each : table_.cases) {
        if (each.status == CaseStatus::done || each.status == CaseStatus::waiting || each.status == CaseStatus::running)
            continue;
        rows.rows.push_back({each.name, status_text(each.status), each.reason.empty() ? unknown : each.reason});
    }
    if (rows.rows.empty()) return;
    add(ReportHeading{2, "Cases without a result"});
    add(ReportParagraph{"They take no part in what this report concludes."});
    add(std::move(rows));
}

void ReportBuilder::add_model_choices() {
    if (!chosen_ || measures_[*chosen_].is_curve) return;
    const StudyMeasure& measure = measures_[*chosen_];
    ReportTable rows{{"choice", measure.name, "against the own model", "CPU time against it"}, {}, {}, 1};
    std::vector<double> deviations;
    for (const ModelChoice& choice : model_choices(table_, groups_, measure)) {
        const auto value = group_mean(table_, groups_[choice.group], measure.values);
        if (choice.deviation) deviations.push_back(*choice.deviation);
        rows.rows.push_back({label_of(choice.group), value ? value_text(measure, *value) : unknown,
                             choice.deviation ? fmt::format("{:+.3g} %", percent * *choice.deviation) : unknown,
                             choice.cost_ratio ? fmt::format("{:.3g}", *choice.cost_ratio) : unknown});
    }
    if (rows.rows.empty()) return;
    add(ReportHeading{2, "Model choices"});
    add(ReportParagraph{"These cases are other models of the rock, each beside the own model with the same numerical "
                        "settings: their differences are no errors, and no finer step makes them smaller."});
    add(std::move(rows));
    if (deviations.size() < 2) return;
    const EnsembleStatistics found = ensemble_statistics(deviations);
    add(ReportParagraph{
        fmt::format("Over {} choices {} differs from that of the own model by {:+.2g} % in the mean (bias) "
                    "with a standard deviation of {:.2g} % (scatter).",
                    found.n, measure.name, percent * found.mean, percent * found.deviation)});
}

/// Linear solves of one of its cases.
std::optional<double> ReportBuilder::solves_of(std::size_t group) const {
    std::vector<double> solves;
    for (const std::size_t i : groups_[group].cases)
        if (runs_[i] && runs_[i]->solves) solves.push_back(*runs_[i]->solves);
    if (solves.empty()) return std::nullopt;
    return ensemble_statistics(solves).mean;
}

/// Whether all settings of a group are those of the scene.
bool ReportBuilder::is_own(std::size_t group) const {
    bool own = true;
    for (std::size_t p = 0; p < table_.parameters.size(); ++p)
        own = own && is_own_setting(table_, p, groups_[group].settings[p]);
    return own;
}

/// "1.2 s of CPU time and 412 solves, 0.6 of the scene's own settings, 0.2 of the reference".
std::string ReportBuilder::cost_text(std::size_t group, double cpu_s) const {
    std::string text = seconds_text(cpu_s) + " of CPU time";
    if (const auto solves = solves_of(group)) text += fmt::format(" and {:.0f} solves", *solves);
    const auto own = own_group(table_, groups_);
    if (!own || *own == group) return text;
    const auto own_cost = group_cost(table_, groups_[*own]);
    if (own_cost && *own_cost > 0.0)
        text += fmt::format(", {:.2g} of {}", cpu_s / *own_cost,
                            is_own(*own) ? "the scene's own settings" : "the settings nearest to the scene's own");
    return text;
}

/// What the scene's own settings come to, or those nearest to them.
std::string ReportBuilder::own_sentence(const StudyMeasure& measure) const {
    const auto own = own_group(table_, groups_);
    if (!own) return "";
    const auto error = group_error(table_, groups_[*own], measure);
    const auto cost = group_cost(table_, groups_[*own]);
    if (!error || !cost) return "";
    return fmt::format("The {}, {}, have an error of {:.2g} % {} and cost {}.",
                       is_own(*own) ? "scene's own settings" : "settings nearest to the scene's own",
                       advised_settings(table_, groups_, *own), percent * *error, on_words(measure),
                       cost_text(*own, *cost));
}

/// What cases that ask for an accuracy come to.
std::vector<std::string> ReportBuilder::accuracy_items(const StudyMeasure& measure) const {
    std::vector<std::string> items;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const auto error = group_error(table_, groups_[g], measure);
        const auto cost = group_cost(table_, groups_[g]);
        if (!takes_own_steps(table_, groups_[g]) || other_models_[g] || !error || !cost) continue;
        items.push_back(fmt::format("{}: error {:.2g} % {}, {}.", advised_settings(table_, groups_, g),
                                    percent * *error, on_words(measure), cost_text(g, *cost)));
    }
    return items;
}

std::string ReportBuilder::sentence(const Advice& advice, const StudyMeasure& measure) const {
    std::string text = fmt::format("For {:.3g} % error {}: ", percent * advice.bound, on_words(measure));
    if (advice.group) {
        const auto references = reference_marks(table_);
        if (std::ranges::any_of(groups_[*advice.group].cases, [&](std::size_t i) { return references[i]; }))
            text += advice.is_unconfirmed ? "only the reference itself, which no finer case confirms: "
                                          : "only the reference itself: ";
        text += fmt::format("{} (error {:.2g} %) costs {}", advised_settings(table_, groups_, *advice.group),
                            percent * advice.error, cost_text(*advice.group, advice.cpu_s));
        if (advice.reference_share) text += fmt::format(", {:.2g} of the reference", *advice.reference_share);
        text += ".";
    } else {
        text += "no settings of this study hold it with a finer case that confirms them.";
    }
    if (!advice.not_confirmed.empty()) {
        constexpr std::size_t most_named = 3;
        std::vector<std::string> names;
        for (std::size_t i = 0; i < std::min(most_named, advice.not_confirmed.size()); ++i)
            names.push_back("(" + label_of(advice.not_confirmed[i]) + ")");
        const std::size_t others = advice.not_confirmed.size() - names.size();
        if (others > 0) names.push_back(fmt::format("{} others", others));
        text += " Cheaper and below it too, but not trusted, since finer cases are above it or are missing: " +
                listed(names) + ".";
    }
    return text;
}

/// What is known of the reference's own error.
std::string ReportBuilder::reference_doubt(const StudyMeasure& measure) const {
    const auto references = reference_marks(table_);
    if (measure.is_curve || std::ranges::find(references, true) == references.end()) return "";
    std::optional<double> uncertainty;
    std::optional<double> scatter;
    for (const StudySeries& series : series_) {
        const StudyGroup& finest = groups_[series.levels.back().group];
        if (std::ranges::none_of(finest.cases, [&](std::size_t i) { return references[i]; })) continue;
        const SeriesValues found = series_values(table_, groups_, series, measure);
        const Convergence result = convergence(found.sizes, found.values, noise_of_values);
        if (result.uncertainty) uncertainty = std::max(uncertainty.value_or(0.0), *result.uncertainty);
        if (result.kind == ConvergenceKind::scattered) scatter = std::max(scatter.value_or(0.0), result.scatter);
    }
    if (scatter)
        return fmt::format("The values that lead to the reference scatter by {}: errors below that mean nothing.",
                           percent_text(*scatter));
    if (uncertainty)
        return fmt::format("The reference itself is uncertain by {}, which comes on top.", percent_text(*uncertainty));
    std::optional<double> nearest;
    for (const StudySeries& series : series_) {
        const std::size_t finest = series.levels.back().group;
        if (table_.along != series.parameter || other_models_[finest]) continue;
        const auto error = group_error(table_, groups_[finest], measure);
        if (error) nearest = std::max(nearest.value_or(0.0), *error);
    }
    if (nearest)
        return fmt::format("The reference's own error is not known from this study, and comes on top; the finest cases "
                           "of each series along {} lie within {} of it.",
                           table_.parameters[*table_.along], percent_text(*nearest));
    return "The reference's own error is not known from this study, and comes on top.";
}

void ReportBuilder::add_recommendation() {
    const auto judged = judged_measures();
    if (judged.empty()) return;
    bool any_cost = false;
    for (const StudyCase& each : table_.cases) any_cost = any_cost || each.cpu_s.has_value();
    if (!any_cost) return;
    add(ReportHeading{2, "Recommendation"});
    add(ReportParagraph{"The cheapest settings whose error is below a bound, where every case that is finer in its "
                        "steps, tolerances or intervals is below it too. Among the cases of the reference's own model "
                        "of the rock."});
    for (const StudyMeasure* const measure : judged) {
        std::vector<std::string> items;
        if (auto own = own_sentence(*measure); !own.empty()) items.push_back(std::move(own));
        for (const Advice& advice : cheapest_settings(table_, groups_, *measure, unbalanced_, options_.bounds))
            items.push_back(sentence(advice, *measure));
        add(ReportList{std::move(items)});
        const std::string doubt = reference_doubt(*measure);
        if (!doubt.empty()) add(ReportParagraph{doubt});
    }
    add(ReportParagraph{
        "CPU times of single short runs vary by some per cent from one to the next; numbers of solves do "
        "not. Of settings whose times are within a tenth of the cheapest the most exact ones are named."});
    auto accurate = accuracy_items(*judged.front());
    if (accurate.empty()) return;
    add(ReportParagraph{
        "Cases with solver.accuracy take their own steps, such that the estimated error of the stress up to "
        "its peak stays below it: the number of steps of a stage says the size of the first one only. "
        "They are confirmed by cases of a smaller accuracy, not by cases of more steps:"});
    add(ReportList{std::move(accurate)});
}

} // namespace

std::vector<std::string> study_pictures_in(const fs::path& directory) {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
        std::string name = entry->path().filename().string();
        if (name.starts_with(picture_prefix) && (name.ends_with(".png") || name.ends_with(".svg")))
            names.push_back(std::move(name));
    }
    std::ranges::sort(names);
    return names;
}

void write_study_report(const StudyTable& table, const fs::path& directory, const StudyReportOptions& options) {
    ReportBuilder builder(table, directory, options);
    make_directory(directory);
    for (const std::string& picture : study_pictures_in(directory)) remove_file(directory / picture);
    const ReportDocument document = builder.build();
    write_file(directory / "study.md", report_markdown(document));
    write_file(directory / "study.html", report_html(document));
}

} // namespace kluft
