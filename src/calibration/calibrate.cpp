#include "kluft/calibration/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "kluft/calibration/closed_forms.hpp"
#include "kluft/calibration/elastic_scene.hpp"
#include "kluft/calibration/judgement.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/core/units.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/studies/ensemble.hpp"

namespace kluft {

namespace {

constexpr double bound_width = 1e-3;  // in logarithms: this near a bound a parameter is at it
constexpr double no_influence = 1e-6; // of a parameter on a target, in tolerances per unit of its logarithm

/// Exact rows, solved again only where a parameter that they depend on has moved.
class RememberedRows {
public:
    RememberedRows(ElasticTargets& targets, const std::vector<char>& influences)
        : targets_(targets), influences_(influences) {}

    std::optional<ResidualRows> operator()(const Eigen::VectorXd& x) {
        Eigen::VectorXd essence = x;
        for (Eigen::Index i = 0; i < x.size(); ++i)
            if (!influences_[static_cast<std::size_t>(i)]) essence[i] = 0.0;
        if (essence_.size() == 0 || essence_ != essence) {
            essence_ = essence;
            rows_ = targets_.residuals_at(x);
        }
        return rows_;
    }

private:
    ElasticTargets& targets_;
    const std::vector<char>& influences_;
    Eigen::VectorXd essence_;
    std::optional<ResidualRows> rows_;
};

/// One call of calibrate.
class CalibrationRun {
public:
    CalibrationRun(const Calibration& calibration, const CalibrationOptions& options, const std::atomic<bool>& stop)
        : calibration_(calibration), options_(options), stop_(stop), runs_(run_targets(calibration)) {}

    CalibrationResult run() {
        {
            const Stopwatch watch(result_.elapsed_s);
            const Eigen::VectorXd start = start_of(calibration_);
            elastic_ = std::make_unique<ElasticTargets>(calibration_, start);
            groups_ = runs_.groups;
            for (std::size_t i = 0; i < elastic_->targets().size(); ++i) {
                const CalibrationTarget& target = calibration_.targets[elastic_->targets()[i]];
                groups_.push_back(
                    {runs_.n_rows + static_cast<Eigen::Index>(i), 1, target.weight, 1.0 / target.tolerance});
            }
            fit_.x = start;
            fit_.influences.assign(calibration_.parameters.size(), 0);
            if (!elastic_->targets().empty()) elastic_stage(start);
            strength_stage(start);
            if (!result_.stopped) judge();
        }
        return std::move(result_);
    }

private:
    void say(const std::string& line) const {
        if (options_.say) options_.say(line);
    }

    void elastic_stage(const Eigen::VectorXd& start) {
        fit_ = fit_elastic(calibration_, *elastic_, start);
        result_.elastic_evaluations = fit_.evaluations;
        const auto values = elastic_->values_at(fit_.x);
        std::vector<std::string> parts;
        for (std::size_t i = 0; values && i < elastic_->targets().size(); ++i) {
            const CalibrationTarget& target = calibration_.targets[elastic_->targets()[i]];
            parts.push_back(
                fmt::format("{} {}", target.name,
                            value_text(values->values[static_cast<Eigen::Index>(i)], measure_of(target.quantity))));
        }
        say(fmt::format("elastic stage: {} after {} evaluations", listed(parts), fit_.evaluations));
    }

    /// The parameters that the elastic targets determine stay, unless the others do not meet the targets.
    void strength_stage(const Eigen::VectorXd& start) {
        std::vector<char> moves(calibration_.parameters.size(), 1);
        const bool some_stay = fit_.is_determined;
        for (std::size_t i = 0; some_stay && i < moves.size(); ++i) moves[i] = fit_.influences[i] ? 0 : 1;
        Eigen::VectorXd from = fit_.x;
        search_ = search_from(from, start, moves);
        const bool all_moved = std::ranges::find(moves, 0) == moves.end();
        if (all_moved || runs_.targets.empty() || search_.ending == SearchEnding::met ||
            search_.ending == SearchEnding::stopped || search_.ending == SearchEnding::failed)
            return finish_search();
        say("the parameters that E and nu determine move too, since the others do not meet the targets");
        const SearchResult first = search_;
        moves.assign(moves.size(), 1);
        search_ = search_from(first.best.x, first.best.x, moves);
        search_.all.insert(search_.all.begin(), first.all.begin(), first.all.end());
        finish_search();
    }

    SearchResult search_from(const Eigen::VectorXd& from, const Eigen::VectorXd& other,
                             const std::vector<char>& moves) {
        RememberedRows remembered(*elastic_, fit_.influences);
        if (runs_.targets.empty()) return elastic_alone(remembered);
        SearchProblem problem;
        problem.lower = problem.upper = from;
        for (Eigen::Index i = 0; i < from.size(); ++i) {
            if (!moves[static_cast<std::size_t>(i)]) continue;
            problem.lower[i] = lower_bounds(calibration_)[i];
            problem.upper[i] = upper_bounds(calibration_)[i];
        }
        problem.starts = starts_from(from, other, moves);
        problem.groups = groups_;
        problem.n_noisy = runs_.n_rows;
        problem.evaluate = [&](const std::vector<Eigen::VectorXd>& places) { return evaluate(places); };
        if (!elastic_->targets().empty()) problem.exact = [&](const Eigen::VectorXd& x) { return remembered(x); };
        problem.expected = [&](const Eigen::VectorXd& x) { return expected_slopes(x); };
        SearchOptions options;
        options.most_evaluations = calibration_.most_evaluations;
        options.show = [&](const Evaluation& each, double worst) { show(each, worst); };
        return search_responses(problem, options);
    }

    /// By runs of what the scenes said when the calibration began: values found with two scenes would be those of none.
    [[nodiscard]] std::optional<std::vector<Evaluation>> evaluate(const std::vector<Eigen::VectorXd>& places) const {
        try {
            auto found = evaluate_by_runs(calibration_, runs_, options_.place, places, stop_);
            require_same_scenes();
            return found;
        } catch (const ResourceError&) {
            require_same_scenes();
            throw;
        }
    }

    void require_same_scenes() const {
        std::string now;
        try {
            now = scenes_digest(calibration_);
        } catch (const InputError&) {
            now.clear(); // another one, whatever it says
        }
        if (now != scenes_)
            throw InputError(
                calibration_.scene.string() +
                ": expected the scenes that the calibration began with, found that one of them has changed "
                "since; the same command runs what they say now");
    }

    /// Where theory meets the targets, and the file's own start where that is another place.
    [[nodiscard]] std::vector<Eigen::VectorXd> starts_from(const Eigen::VectorXd& from, const Eigen::VectorXd& other,
                                                           const std::vector<char>& moves) const {
        Eigen::VectorXd own = from;
        for (Eigen::Index i = 0; i < from.size(); ++i)
            if (moves[static_cast<std::size_t>(i)] && !fit_.influences[static_cast<std::size_t>(i)]) own[i] = other[i];
        const auto by_theory = expected_start(calibration_, runs_.targets, own, moves);
        if (!by_theory || (*by_theory - own).lpNorm<Eigen::Infinity>() < bound_width) return {own};
        return {*by_theory, own};
    }

    /// The rows of each run target; those of a curve have no theory.
    [[nodiscard]] Eigen::MatrixXd expected_slopes(const Eigen::VectorXd& x) const {
        const ExpectedRows expected = expected_rows(calibration_, runs_.targets, x);
        Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(runs_.n_rows, x.size());
        for (std::size_t t = 0; t < runs_.groups.size(); ++t)
            if (expected.known[t])
                slopes.row(runs_.groups[t].first) = expected.jacobian.row(static_cast<Eigen::Index>(t));
        return slopes;
    }

    SearchResult elastic_alone(RememberedRows& rows) {
        SearchResult result;
        const auto at = rows(fit_.x);
        result.best.x = fit_.x;
        result.best.is_usable = at.has_value();
        if (!at) return result;
        result.rows = at->values;
        result.jacobian = at->jacobian;
        result.ending = worst_group(groups_, result.rows) <= 1.0 ? SearchEnding::met : SearchEnding::minimum;
        return result;
    }

    void show(const Evaluation& each, double worst) {
        ++result_.evaluations;
        result_.worst.push_back(worst);
        std::vector<std::string> parts;
        for (std::size_t i = 0; i < calibration_.parameters.size(); ++i)
            parts.push_back(fmt::format(
                "{} {}", calibration_.parameters[i].name,
                value_text(std::exp(each.x[static_cast<Eigen::Index>(i)]), calibration_.parameters[i].measure)));
        say(fmt::format("parameter set {}: {}: {}", result_.evaluations, listed(parts),
                        each.is_usable ? fmt::format("largest difference {:.3g} tolerances", worst)
                                       : "not usable: " + each.note));
    }

    void finish_search() {
        result_.stopped = search_.ending == SearchEnding::stopped;
        result_.x = search_.best.x.size() > 0 ? search_.best.x : fit_.x;
    }

    // ---- what is said of it ------------------------------------------------------------------------------------

    void judge() {
        judge_targets();
        judge_parameters();
        result_.met = std::ranges::all_of(result_.targets, [](const TargetResult& each) { return each.met; });
        if (!result_.met) find_obstacles();
        if (elastic_->have_fractures())
            result_.warnings.emplace_back(
                "The elastic targets are met with mapped fractures closed and locked: a run in "
                "which they slip is softer. Run the calibrated scene and compare its "
                "youngs_modulus before you use it.");
        for (std::size_t t = 0; t < result_.targets.size(); ++t)
            warn_of_copies(calibration_.targets[t], result_.targets[t]);
        if (has_rows()) warn_of_parameters_told_together();
    }

    /// Of several that are not determined the two which exchange with each other most are named first.
    void warn_of_parameters_told_together() {
        std::vector<std::string> names;
        for (const std::size_t p : told_together(search_.jacobian)) names.push_back(calibration_.parameters[p].name);
        if (names.size() < 2) return;
        const std::vector<std::string> others(names.begin() + 2, names.end());
        result_.warnings.push_back(fmt::format(
            "The targets do not tell {} and {} apart: other values of both{} meet them as well. Give one of the two by "
            "itself, or a target that changes with one of them only.",
            names[0], names[1], others.empty() ? "" : fmt::format(", with others of {},", listed(others))));
    }

    /// A target that the mean of the copies meets, and a run of one net may miss.
    void warn_of_copies(const CalibrationTarget& target, const TargetResult& found) {
        if (!found.met || found.copies.size() < 2 || target.quantity == TargetQuantity::curve) return;
        const auto [least, most] = std::ranges::minmax(found.copies);
        if (std::max(target.value - least, most - target.value) <= target.tolerance * std::abs(target.value)) return;
        const Measure measure = measure_of(target.quantity);
        result_.warnings.push_back(fmt::format(
            "{} is met by the mean of {} copies; single ones lie between {} and {}, and so may a run of the "
            "calibrated scene, which is one net of many.",
            target.name, found.copies.size(), value_text(least, measure), value_text(most, measure)));
    }

    /// Which target a group of rows belongs to.
    [[nodiscard]] std::size_t target_of(std::size_t group) const {
        const std::size_t n_runs = runs_.targets.size();
        return group < n_runs ? runs_.targets[group] : elastic_->targets()[group - n_runs];
    }

    [[nodiscard]] bool has_rows() const { return search_.best.is_usable && search_.rows.size() > 0; }

    void judge_targets() {
        result_.targets.resize(calibration_.targets.size());
        if (!has_rows()) return judge_elastic_targets();
        copies_ = rows_of_copies();
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const CalibrationTarget& target = calibration_.targets[target_of(g)];
            TargetResult& found = result_.targets[target_of(g)];
            const bool is_curve = target.quantity == TargetQuantity::curve;
            const auto error_in = [&](const Eigen::VectorXd& rows) {
                const Eigen::VectorXd own = rows.segment(groups_[g].first, groups_[g].n);
                return target.tolerance * (is_curve ? own.norm() : own[0]);
            };
            const auto value_of = [&](double error) { return is_curve ? error : target.value * (1.0 + error); };
            found.error = error_in(search_.rows);
            found.found = value_of(found.error);
            found.met = std::abs(found.error) <= target.tolerance;
            for (const Eigen::VectorXd& rows : copies_) found.copies.push_back(value_of(error_in(rows)));
        }
    }

    /// Those are known where no run told anything.
    void judge_elastic_targets() {
        const auto rows = elastic_->residuals_at(result_.x);
        for (std::size_t i = 0; rows && i < elastic_->targets().size(); ++i) {
            const CalibrationTarget& target = calibration_.targets[elastic_->targets()[i]];
            TargetResult& found = result_.targets[elastic_->targets()[i]];
            found.error = target.tolerance * rows->values[static_cast<Eigen::Index>(i)];
            found.found = target.value * (1.0 + found.error);
            found.met = std::abs(found.error) <= target.tolerance;
        }
    }

    /// All rows of each copy at the best place, the elastic ones of its own net.
    [[nodiscard]] std::vector<Eigen::VectorXd> rows_of_copies() const {
        std::vector<Eigen::VectorXd> copies;
        const auto set = settings_at(calibration_, result_.x);
        for (int replica = 0; replica < calibration_.replicas.count; ++replica) {
            Eigen::VectorXd rows = search_.rows;
            if (!runs_.targets.empty())
                rows.head(runs_.n_rows) = search_.best.copies[static_cast<std::size_t>(replica)];
            if (!elastic_->targets().empty()) {
                ElasticTargets own(calibration_, result_.x,
                                   settings_of_copy(calibration_, calibration_.scene, set, replica));
                const auto found = own.residuals_at(result_.x);
                if (found) rows.tail(found->values.size()) = found->values;
            }
            copies.push_back(std::move(rows));
        }
        return copies;
    }

    [[nodiscard]] std::vector<char> parameters_at_bounds() const {
        std::vector<char> at_bound;
        for (Eigen::Index i = 0; i < result_.x.size(); ++i)
            at_bound.push_back(result_.x[i] < lower_bounds(calibration_)[i] + bound_width ||
                                       result_.x[i] > upper_bounds(calibration_)[i] - bound_width
                                   ? 1
                                   : 0);
        return at_bound;
    }

    void judge_parameters() {
        const auto at_bound = parameters_at_bounds();
        const auto known = has_rows() ? determined(search_.jacobian) : std::vector<char>{};
        const auto widths =
            has_rows() ? confidence_of(search_.jacobian, copies_, groups_) : std::vector<std::optional<double>>{};
        for (std::size_t i = 0; i < calibration_.parameters.size(); ++i) {
            const double x = result_.x[static_cast<Eigen::Index>(i)];
            ParameterResult parameter;
            parameter.value = std::exp(x);
            parameter.at_bound = at_bound[i] != 0;
            parameter.is_determined = !known.empty() && known[i] != 0;
            if (!widths.empty() && widths[i]) {
                parameter.low = std::exp(x - *widths[i]);
                parameter.high = std::exp(x + *widths[i]);
            }
            result_.parameters.push_back(parameter);
        }
    }

    void find_obstacles() {
        if (!has_rows()) {
            result_.obstacles.push_back(
                "Nothing could be evaluated at the start: " +
                (search_.all.empty() ? std::string("the elastic body has no equilibrium") : search_.all.front().note) +
                ".");
            return;
        }
        const auto at_bound = parameters_at_bounds();
        for (const auto& [i, j] : opposing_groups(search_.jacobian, search_.rows, groups_, at_bound))
            result_.obstacles.push_back(
                fmt::format("{} and {} oppose each other: what brings the one nearer takes the other one away.",
                            calibration_.targets[target_of(i)].name, calibration_.targets[target_of(j)].name));
        for (std::size_t g = 0; g < groups_.size(); ++g) add_obstacles_of(g, at_bound);
        if (search_.ending == SearchEnding::evaluations)
            result_.obstacles.push_back(fmt::format("The {} parameter sets that the file allows are used up "
                                                    "(evaluations).",
                                                    calibration_.most_evaluations));
        if (result_.obstacles.empty())
            result_.obstacles.push_back("No step of the local model promises an improvement.");
    }

    void add_obstacles_of(std::size_t g, const std::vector<char>& at_bound) {
        const std::size_t t = target_of(g);
        const CalibrationTarget& target = calibration_.targets[t];
        if (result_.targets[t].met) return;
        const Eigen::MatrixXd own = search_.jacobian.middleRows(groups_[g].first, groups_[g].n);
        const Eigen::VectorXd gradient = own.transpose() * search_.rows.segment(groups_[g].first, groups_[g].n);
        if (own.norm() < no_influence)
            result_.obstacles.push_back(fmt::format("No parameter changes {}.", target.name));
        for (std::size_t i = 0; i < at_bound.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(i);
            const bool is_low = result_.x[at] < lower_bounds(calibration_)[at] + bound_width;
            const double outward = is_low ? gradient[at] : -gradient[at]; // the squares fall against their gradient
            if (!at_bound[i] || outward < no_influence) continue;
            const CalibrationParameter& parameter = calibration_.parameters[i];
            result_.obstacles.push_back(
                fmt::format("{} is at its {} bound, {}; beyond it {} would come nearer.", parameter.name,
                            is_low ? "lower" : "upper",
                            value_text(is_low ? parameter.from : parameter.to, parameter.measure), target.name));
        }
        add_refusals(target, gradient, at_bound);
        add_scatter(target, result_.targets[t]);
    }

    /// Parameters that cannot go on towards the target because the scene is refused beside where they are.
    void add_refusals(const CalibrationTarget& target, const Eigen::VectorXd& gradient,
                      const std::vector<char>& at_bound) {
        constexpr double beside = 0.01; // in logarithms
        for (std::size_t i = 0; i < calibration_.parameters.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(i);
            if (at_bound[i] || std::abs(gradient[at]) < no_influence) continue;
            Eigen::VectorXd x = result_.x;
            x[at] += gradient[at] < 0.0 ? beside : -beside;
            const std::string why = why_refused(target, x);
            if (why.empty()) continue;
            const CalibrationParameter& parameter = calibration_.parameters[i];
            result_.obstacles.push_back(
                fmt::format("{} stays at {}: {} would come nearer beyond it, where the scene is refused: {}",
                            parameter.name, value_text(std::exp(result_.x[at]), parameter.measure), target.name, why));
        }
    }

    /// What the scene of a target is refused for with these parameters; "" if it is not.
    [[nodiscard]] std::string why_refused(const CalibrationTarget& target, const Eigen::VectorXd& x) const {
        std::vector<StudySetting> settings = settings_at(calibration_, x);
        settings.insert(settings.end(), target.set.begin(), target.set.end());
        try {
            (void)build_scene_model(read_scene(target.scene, assignments(settings)));
        } catch (const InputError& error) {
            return error.what();
        }
        return {};
    }

    void add_scatter(const CalibrationTarget& target, const TargetResult& found) {
        const EnsembleStatistics scatter = ensemble_statistics(found.copies);
        if (!scatter.half_width || target.quantity == TargetQuantity::curve) return;
        const double relative = *scatter.half_width / target.value;
        if (std::abs(found.error) - target.tolerance > relative) return;
        result_.obstacles.push_back(
            fmt::format("The mean of {} is known to {:.2g} % only, from the scatter of {} copies: more replicas would "
                        "tell.",
                        target.name, percent * relative, scatter.n));
    }

    const Calibration& calibration_;
    const CalibrationOptions& options_;
    const std::atomic<bool>& stop_;
    std::string scenes_ = scenes_digest(calibration_); ///< as the calibration began
    RunTargets runs_;
    std::unique_ptr<ElasticTargets> elastic_;
    std::vector<RowGroup> groups_; ///< of the run targets, then of the elastic ones
    ElasticFit fit_;
    SearchResult search_;
    std::vector<Eigen::VectorXd> copies_; ///< rows of each copy at the best place
    CalibrationResult result_;
};

} // namespace

CalibrationResult calibrate(const Calibration& calibration, const CalibrationOptions& options,
                            const std::atomic<bool>& stop) {
    return CalibrationRun(calibration, options, stop).run();
}

} // namespace kluft
