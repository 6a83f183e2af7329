#include "kluft/calibration/response_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "kluft/core/dense_decompositions.hpp"

namespace kluft {

namespace {

constexpr double reach = 2.0;       // of the radius: evaluations that a local model is made of
constexpr double known_slope = 1.0; // scatter of slopes about what theory expects, in units
constexpr double unknown_slope = 2.0;
constexpr double likely_curvature = 0.5;
constexpr double left_out = 0.25;      // by the model, times the square of the distance, in units
constexpr double least_error = 0.1;    // of an evaluation, in tolerances
constexpr double spread_wanted = 0.25; // of the evaluations in each direction, in radii
constexpr double good_ratio = 0.7;     // of actual to promised gain
constexpr double poor_ratio = 0.25;
constexpr double least_gain = 1e-3; // of the objective, below which a step promises nothing
constexpr double shortest_step = 1e-3;

double squares(const std::vector<RowGroup>& groups, const Eigen::VectorXd& rows) {
    double sum = 0.0;
    for (const RowGroup& group : groups) sum += group.weight * rows.segment(group.first, group.n).squaredNorm();
    return sum;
}

std::vector<Evaluation> near(const std::vector<Evaluation>& all, const Eigen::VectorXd& centre, double radius) {
    std::vector<Evaluation> chosen;
    for (const Evaluation& each : all)
        if (each.is_usable && (each.x - centre).lpNorm<Eigen::Infinity>() <= reach * radius) chosen.push_back(each);
    return chosen;
}

/// What is known of a row before it is fitted.
struct RowPrior {
    Eigen::Index row = 0;
    double unit = 1.0;
    double slope = 1.0; ///< scatter about the expected one, in units
};

/// Value, differences from the expected slopes, curvatures.
struct RowFit {
    Eigen::VectorXd terms;
    double misfit = 0.0; ///< mean square of the differences over their variances
};

/// Of one evaluation, about the model: of its mean, and what the model leaves out at its distance.
double variance_of(const Evaluation& each, const RowPrior& prior, double distance_squared, double scatter) {
    return each.variance_of_mean()[prior.row] + scatter + std::pow(left_out * prior.unit * distance_squared, 2);
}

/// Weighted least squares of one row over all usable evaluations, with slopes and curvatures drawn to what is expected;
/// `scatter`: variance that all evaluations have in common.
RowFit fit_row(const std::vector<Evaluation>& all, const RowPrior& prior, const LocalModel& model,
               const std::vector<Eigen::Index>& moving, double scatter) {
    const auto n = static_cast<Eigen::Index>(moving.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(1 + 2 * n, 1 + 2 * n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(1 + 2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
        normal(1 + i, 1 + i) = 1.0 / std::pow(prior.slope * prior.unit, 2);
        normal(1 + n + i, 1 + n + i) = 1.0 / std::pow(likely_curvature * prior.unit, 2);
    }
    const auto terms_of = [&](const Eigen::VectorXd& whole) {
        Eigen::VectorXd terms(1 + 2 * n);
        const Eigen::VectorXd d = whole(moving);
        terms << 1.0, d, d.cwiseProduct(d);
        return terms;
    };
    const auto value_of = [&](const Evaluation& each, const Eigen::VectorXd& whole) {
        return each.mean()[prior.row] - model.slope.row(prior.row).dot(whole);
    };
    for (const Evaluation& each : all) {
        if (!each.is_usable) continue;
        const Eigen::VectorXd whole = each.x - model.centre;
        const double variance = variance_of(each, prior, whole.squaredNorm(), scatter);
        const Eigen::VectorXd terms = terms_of(whole);
        normal += terms * terms.transpose() / variance;
        right += terms * value_of(each, whole) / variance;
    }
    RowFit fit{normal.ldlt().solve(right), 0.0};
    double weights = 0.0;
    for (const Evaluation& each : all) {
        if (!each.is_usable) continue;
        const Eigen::VectorXd whole = each.x - model.centre;
        const double variance = variance_of(each, prior, whole.squaredNorm(), scatter);
        const double error = value_of(each, whole) - fit.terms.dot(terms_of(whole));
        fit.misfit += error * error / (variance * variance);
        weights += 1.0 / variance;
    }
    fit.misfit /= weights;
    return fit;
}

/// The same with the scatter that the evaluations themselves show: those of one copy, or of bodies that jump, lie about any
/// smooth model by more than a tenth of a tolerance.
RowFit fit_row_with_scatter(const std::vector<Evaluation>& all, const RowPrior& prior, const LocalModel& model,
                            const std::vector<Eigen::Index>& moving) {
    constexpr int n_passes = 8;
    double scatter = least_error * least_error;
    RowFit fit = fit_row(all, prior, model, moving, scatter);
    for (int pass = 0; pass < n_passes && fit.misfit > 1.0; ++pass) {
        scatter *= std::min(fit.misfit, 100.0);
        fit = fit_row(all, prior, model, moving, scatter);
    }
    return fit;
}

/// One call of search_responses.
class ResponseSearch {
public:
    ResponseSearch(const SearchProblem& problem, const SearchOptions& options)
        : problem_(problem), options_(options), radius_(options.radius) {
        for (Eigen::Index i = 0; i < problem.lower.size(); ++i)
            if (problem.lower[i] < problem.upper[i]) moving_.push_back(i);
    }

    SearchResult run() {
        evaluate(problem_.starts);
        if (result_.ending == SearchEnding::stopped) return std::move(result_);
        if (!best_) return std::move(result_);
        iterate();
        result_.best = result_.all[*best_];
        result_.rows = rows_[*best_];
        result_.jacobian = jacobian();
        return std::move(result_);
    }

private:
    [[nodiscard]] const Eigen::VectorXd& best_x() const { return result_.all[*best_].x; }
    [[nodiscard]] int n_left() const { return options_.most_evaluations - static_cast<int>(result_.all.size()); }

    void iterate() {
        bool is_stopped = false;
        while (!is_stopped) {
            if (worst_group(problem_.groups, rows_[*best_]) <= 1.0) return end(SearchEnding::met);
            if (n_left() <= 0) return end(SearchEnding::evaluations);
            const bool fills = wants_directions_ || !theory_knows_all();
            is_stopped = fills && !directions().empty() ? !evaluate(directions()) : !step();
        }
    }

    void end(SearchEnding ending) { result_.ending = ending; }

    /// Whether the expected derivatives say something of each noisy row.
    [[nodiscard]] bool theory_knows_all() const {
        const Eigen::MatrixXd expected = problem_.expected(best_x());
        for (Eigen::Index i = 0; i < problem_.n_noisy; ++i)
            if (expected.row(i)(moving_).isZero(0.0)) return false;
        return true;
    }

    /// Evaluates places; false where the search is to end.
    bool evaluate(const std::vector<Eigen::VectorXd>& places) {
        auto found = problem_.evaluate(places);
        if (!found) {
            end(SearchEnding::stopped);
            return false;
        }
        for (Evaluation& each : *found) {
            Eigen::VectorXd rows;
            const auto exact = problem_.exact ? problem_.exact(each.x) : ResidualRows{};
            each.is_usable = each.is_usable && exact.has_value();
            if (each.is_usable) {
                rows.resize(problem_.n_noisy + exact->values.size());
                if (problem_.n_noisy > 0) rows.head(problem_.n_noisy) = each.mean();
                rows.tail(exact->values.size()) = exact->values;
            }
            const double worst =
                each.is_usable ? worst_group(problem_.groups, rows) : std::numeric_limits<double>::infinity();
            if (options_.show) options_.show(each, worst);
            result_.all.push_back(std::move(each));
            rows_.push_back(std::move(rows));
            const std::size_t last = rows_.size() - 1;
            if (result_.all[last].is_usable && (!best_ || objective(last) < objective(*best_))) best_ = last;
        }
        return true;
    }

    [[nodiscard]] double objective(std::size_t i) const { return squares(problem_.groups, rows_[i]); }

    [[nodiscard]] bool was_tried(const Eigen::VectorXd& x) const {
        return std::ranges::any_of(result_.all, [&](const Evaluation& each) {
            return (each.x - x).lpNorm<Eigen::Infinity>() < shortest_step;
        });
    }

    /// A place on the way from the best one that was not tried: half as far until there is one.
    [[nodiscard]] Eigen::VectorXd untried(Eigen::VectorXd place) const {
        while (was_tried(place) && (place - best_x()).norm() > shortest_step) place = 0.5 * (place + best_x());
        return place;
    }

    /// Places that would tell the slopes in directions of which the evaluations near the best say little.
    [[nodiscard]] std::vector<Eigen::VectorXd> directions() const {
        const auto chosen = near(result_.all, best_x(), radius_);
        const auto n = static_cast<Eigen::Index>(moving_.size());
        Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(std::max(n, static_cast<Eigen::Index>(chosen.size())), n);
        for (std::size_t i = 0; i < chosen.size(); ++i)
            moves.row(static_cast<Eigen::Index>(i)) = (chosen[i].x - best_x())(moving_).transpose() / radius_;
        const SingularValues spread = singular_values(moves);
        std::vector<Eigen::VectorXd> places;
        for (Eigen::Index i = 0; i < n && static_cast<int>(places.size()) < n_left(); ++i) {
            if (spread.values[i] >= spread_wanted) continue;
            const Eigen::VectorXd there = inside(spread.v.col(i));
            const Eigen::VectorXd back = inside(-spread.v.col(i));
            const bool is_there_longer = (there - best_x()).norm() >= (back - best_x()).norm();
            const Eigen::VectorXd& longer = is_there_longer ? there : back;
            const Eigen::VectorXd& shorter = is_there_longer ? back : there;
            const bool turns = was_tried(longer) && !was_tried(shorter);
            const Eigen::VectorXd place = turns ? shorter : untried(longer);
            if ((place - best_x()).norm() <= shortest_step) continue;
            places.push_back(place);
            if (is_at_start() && n_left() > static_cast<int>(places.size())) places.push_back(shorter);
        }
        return places;
    }

    /// There both sides are looked at: slopes over a wide range are those of the means of jumps.
    [[nodiscard]] bool is_at_start() const { return result_.all.size() == problem_.starts.size(); }

    [[nodiscard]] Eigen::VectorXd inside(const Eigen::VectorXd& direction) const {
        Eigen::VectorXd x = best_x();
        x(moving_) += radius_ * direction;
        return x.cwiseMax(problem_.lower).cwiseMin(problem_.upper);
    }

    [[nodiscard]] LocalModel local_model() const {
        return fit_local_model(result_.all, best_x(), problem_.expected(best_x()), problem_.groups, moving_);
    }

    /// The rows of the local model and the exact ones, each by the root of its weight.
    [[nodiscard]] std::optional<ResidualRows> modelled(const LocalModel& model, const Eigen::VectorXd& x) const {
        const auto exact = problem_.exact ? problem_.exact(x) : ResidualRows{{}, Eigen::MatrixXd(0, x.size())};
        if (!exact) return std::nullopt;
        const ResidualRows noisy = model.at(x);
        const Eigen::Index n_rows = problem_.n_noisy + exact->values.size();
        ResidualRows all{Eigen::VectorXd(n_rows), Eigen::MatrixXd(n_rows, x.size())};
        all.values << noisy.values, exact->values;
        all.jacobian << noisy.jacobian, exact->jacobian;
        return all;
    }

    [[nodiscard]] std::optional<ResidualRows> weighted(const LocalModel& model, const Eigen::VectorXd& x) const {
        auto all = modelled(model, x);
        if (!all) return std::nullopt;
        for (const RowGroup& group : problem_.groups) {
            all->values.segment(group.first, group.n) *= std::sqrt(group.weight);
            all->jacobian.middleRows(group.first, group.n) *= std::sqrt(group.weight);
        }
        return all;
    }

    /// One step in the trust region; false where the search is to end.
    bool step() {
        const LocalModel model = local_model();
        const Eigen::VectorXd from = best_x();
        const Eigen::VectorXd lower = problem_.lower.cwiseMax((from.array() - radius_).matrix());
        const Eigen::VectorXd upper = problem_.upper.cwiseMin((from.array() + radius_).matrix());
        const auto function = [&](const Eigen::VectorXd& x) { return weighted(model, x); };
        const auto before = function(from);
        const auto found = minimise_squares(function, from, lower, upper);
        const double promised = before->values.squaredNorm() - found.residuals.values.squaredNorm();
        const double length = (found.x - from).lpNorm<Eigen::Infinity>();
        if (promised < least_gain * objective(*best_) || length < shortest_step) return retry(SearchEnding::minimum);
        if (was_tried(found.x)) { // and was no better: the region must become smaller than the way there
            radius_ = std::min(radius_, length);
            return retry(SearchEnding::minimum);
        }
        const double old = objective(*best_);
        const std::size_t n_before = result_.all.size();
        if (!evaluate({found.x})) return false;
        const double gained = result_.all[n_before].is_usable ? old - objective(n_before) : -old;
        const bool at_edge = length > 0.99 * radius_;
        if (gained > good_ratio * promised && at_edge) radius_ = std::min(2.0 * radius_, options_.largest_radius);
        if (gained < poor_ratio * promised) return retry(SearchEnding::minimum);
        return true;
    }

    /// After a step that promised or brought little: first all directions, then a smaller region.
    bool retry(SearchEnding ending) {
        if (!wants_directions_ && theory_knows_all() && !directions().empty()) {
            wants_directions_ = true;
            return true;
        }
        radius_ *= 0.5;
        if (radius_ >= options_.least_radius) return true;
        end(ending);
        return false;
    }

    [[nodiscard]] Eigen::MatrixXd jacobian() const {
        const auto at_best = modelled(local_model(), best_x());
        return at_best ? at_best->jacobian : Eigen::MatrixXd(0, best_x().size());
    }

    const SearchProblem& problem_;
    const SearchOptions& options_;
    double radius_;
    std::vector<Eigen::Index> moving_;
    std::vector<Eigen::VectorXd> rows_; ///< per evaluation; empty where it is not usable
    std::optional<std::size_t> best_;
    bool wants_directions_ = false; ///< what theory expects did not do
    SearchResult result_;
};

} // namespace

Eigen::VectorXd Evaluation::mean() const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(copies.front().size());
    for (const Eigen::VectorXd& each : copies) sum += each;
    return sum / static_cast<double>(copies.size());
}

Eigen::VectorXd Evaluation::variance_of_mean() const {
    const Eigen::VectorXd middle = mean();
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(middle.size());
    for (const Eigen::VectorXd& each : copies) squares += (each - middle).cwiseAbs2();
    const auto n = static_cast<double>(copies.size());
    return copies.size() < 2 ? squares : Eigen::VectorXd(squares / (n * (n - 1.0)));
}

double worst_group(const std::vector<RowGroup>& groups, const Eigen::VectorXd& rows) {
    double worst = 0.0;
    for (const RowGroup& group : groups) worst = std::max(worst, rows.segment(group.first, group.n).norm());
    return worst;
}

SearchResult search_responses(const SearchProblem& problem, const SearchOptions& options) {
    return ResponseSearch(problem, options).run();
}

ResidualRows LocalModel::at(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd d = x - centre;
    ResidualRows result;
    result.values = value + slope * d + curvature * d.cwiseProduct(d);
    result.jacobian = slope + 2.0 * curvature * d.asDiagonal();
    return result;
}

LocalModel fit_local_model(const std::vector<Evaluation>& all, const Eigen::VectorXd& centre,
                           const Eigen::MatrixXd& expected, const std::vector<RowGroup>& groups,
                           const std::vector<Eigen::Index>& moving) {
    const auto n = static_cast<Eigen::Index>(moving.size());
    LocalModel model{centre, Eigen::VectorXd(expected.rows()), expected,
                     Eigen::MatrixXd::Zero(expected.rows(), centre.size())};
    for (const RowGroup& group : groups) {
        for (Eigen::Index row = group.first; row < std::min(group.first + group.n, expected.rows()); ++row) {
            const bool is_known = !expected.row(row)(moving).isZero(0.0);
            const RowFit fit = fit_row_with_scatter(
                all, {.row = row, .unit = group.unit, .slope = is_known ? known_slope : unknown_slope}, model, moving);
            model.value[row] = fit.terms[0];
            for (Eigen::Index i = 0; i < n; ++i) {
                model.slope(row, moving[static_cast<std::size_t>(i)]) += fit.terms[1 + i];
                model.curvature(row, moving[static_cast<std::size_t>(i)]) = fit.terms[1 + n + i];
            }
        }
    }
    return model;
}

} // namespace kluft
