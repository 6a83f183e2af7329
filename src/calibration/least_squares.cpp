#include "kluft/calibration/least_squares.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>

#include "kluft/assembly/blas.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"

namespace kluft {

namespace {

using Ipopt::Index;
using Ipopt::Number;

constexpr double barrier_start = 1e-13; ///< next to sums of squares of about one far from the minimum
constexpr double bound_push = 1e-9;
constexpr double optimality = 1e-13;

/// The sum of squares as Ipopt asks for it. A class because Ipopt's interface is one.
class SumOfSquares : public Ipopt::TNLP {
public:
    SumOfSquares(const ResidualFunction& function, Eigen::VectorXd start, const Eigen::VectorXd& lower,
                 const Eigen::VectorXd& upper, const LeastSquaresOptions& options)
        : function_(function), start_(std::move(start)), lower_(lower), upper_(upper), options_(options) {}

    bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag, IndexStyleEnum& index_style) override {
        n = static_cast<Index>(start_.size());
        m = 0;
        nnz_jac_g = 0;
        nnz_h_lag = n * (n + 1) / 2;
        index_style = C_STYLE;
        return true;
    }

    bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index, Number*, Number*) override {
        std::copy_n(lower_.data(), n, x_l);
        std::copy_n(upper_.data(), n, x_u);
        return true;
    }

    bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
        std::copy_n(start_.data(), n, x);
        return true;
    }

    bool eval_f(Index n, const Number* x, bool, Number& value) override {
        if (!evaluate(n, x)) return false;
        value = 0.5 * last_->values.squaredNorm();
        return true;
    }

    bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
        if (!evaluate(n, x)) return false;
        Eigen::Map<Eigen::VectorXd>(gradient, n) = last_->jacobian.transpose() * last_->values;
        return true;
    }

    bool eval_g(Index, const Number*, bool, Index, Number*) override { return true; }
    bool eval_jac_g(Index, const Number*, bool, Index, Index, Index*, Index*, Number*) override { return true; }

    bool eval_h(Index n, const Number* x, bool, Number factor, Index, const Number*, bool, Index, Index* rows,
                Index* columns, Number* values) override {
        if (values == nullptr) {
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j <= i; ++j) {
                    *rows++ = i;
                    *columns++ = j;
                }
            }
            return true;
        }
        if (!evaluate(n, x)) return false;
        const Eigen::MatrixXd hessian = factor * last_->jacobian.transpose() * last_->jacobian;
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j <= i; ++j) *values++ = hessian(i, j);
        return true;
    }

    bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number, Number, Number,
                               Number, Index, const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
        return !is_met() && best.evaluations < options_.max_evaluations;
    }

    void finalize_solution(Ipopt::SolverReturn, Index, const Number*, const Number*, const Number*, Index,
                           const Number*, const Number*, Number, const Ipopt::IpoptData*,
                           Ipopt::IpoptCalculatedQuantities*) override {}

    [[nodiscard]] bool is_met() const {
        const Eigen::Index n_all = best.residuals.values.size();
        const Eigen::Index n = options_.n_judged < 0 ? n_all : options_.n_judged;
        return n_all > 0 && best.residuals.values.head(n).lpNorm<Eigen::Infinity>() <= options_.residual;
    }

    LeastSquaresResult best;

private:
    bool evaluate(Index n, const Number* x) {
        const Eigen::Map<const Eigen::VectorXd> at(x, n);
        if (is_evaluated_ && at_ == at) return last_.has_value();
        at_ = at;
        is_evaluated_ = true;
        last_ = function_(at_);
        ++best.evaluations;
        if (!last_ || !last_->values.allFinite() || !last_->jacobian.allFinite()) {
            last_.reset();
            return false;
        }
        const double value = last_->values.squaredNorm();
        if (value < least_) {
            least_ = value;
            best.x = at_;
            best.residuals = *last_;
        }
        return true;
    }

    const ResidualFunction& function_;
    Eigen::VectorXd start_;
    const Eigen::VectorXd& lower_;
    const Eigen::VectorXd& upper_;
    const LeastSquaresOptions& options_;
    Eigen::VectorXd at_;
    std::optional<ResidualRows> last_; ///< at at_
    bool is_evaluated_ = false;
    double least_ = std::numeric_limits<double>::infinity();
};

bool set_ipopt_options(Ipopt::OptionsList& options, const LeastSquaresOptions& wanted) {
    bool known = true;
    const auto text = [&](const char* name, const char* value) {
        known = options.SetStringValue(name, value) && known;
    };
    const auto number = [&](const char* name, double value) { known = options.SetNumericValue(name, value) && known; };
    text("sb", "yes"); // no banner
    known = options.SetIntegerValue("print_level", 0) && known;
    text("linear_solver", "mumps");
    text("nlp_scaling_method", "none");
    text("honor_original_bounds", "yes");
    number("bound_relax_factor", 0.0);
    number("bound_push", bound_push);
    number("bound_frac", bound_push);
    number("mu_init", barrier_start);
    text("bound_mult_init_method", "mu-based");
    for (const char* const name : {"tol", "dual_inf_tol", "compl_inf_tol"}) number(name, optimality);
    known = options.SetIntegerValue("max_iter", wanted.max_evaluations) && known;
    return known;
}

LeastSquaresResult minimise_free(const ResidualFunction& function, const Eigen::VectorXd& start,
                                 const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                 const LeastSquaresOptions& options) {
    prepare_blas(); // Ipopt factorizes with it
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
    if (!set_ipopt_options(*application->Options(), options) ||
        application->Initialize("") != Ipopt::Solve_Succeeded) // "": no file of options
        throw std::runtime_error("Ipopt does not know its options");
    const Ipopt::SmartPtr<SumOfSquares> problem = new SumOfSquares(function, start, lower, upper, options);
    const auto status = application->OptimizeTNLP(Ipopt::GetRawPtr(problem));
    if (status == Ipopt::Insufficient_Memory) throw ResourceError("out of memory"); // Ipopt catches what says so
    require_memory();
    LeastSquaresResult result = problem->best;
    if (result.x.size() == 0) throw InputError("the start of the calibration cannot be evaluated");
    result.converged =
        problem->is_met() || status == Ipopt::Solve_Succeeded || status == Ipopt::Solved_To_Acceptable_Level;
    return result;
}

LeastSquaresResult evaluated_once(const ResidualFunction& function, const Eigen::VectorXd& x) {
    const auto residuals = function(x);
    if (!residuals) throw InputError("the start of the calibration cannot be evaluated");
    return {.x = x, .residuals = *residuals, .evaluations = 1, .converged = true};
}

} // namespace

LeastSquaresResult minimise_squares(const ResidualFunction& function, const Eigen::VectorXd& start,
                                    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                    const LeastSquaresOptions& options) {
    const Eigen::VectorXd inside = start.cwiseMax(lower).cwiseMin(upper);
    std::vector<Eigen::Index> moving;
    for (Eigen::Index i = 0; i < inside.size(); ++i)
        if (lower[i] < upper[i]) moving.push_back(i);
    if (moving.empty()) return evaluated_once(function, inside);
    const auto whole = [&](const Eigen::VectorXd& part) {
        Eigen::VectorXd x = inside;
        x(moving) = part;
        return x;
    };
    const ResidualFunction of_part = [&](const Eigen::VectorXd& part) {
        auto residuals = function(whole(part));
        if (residuals) residuals->jacobian = Eigen::MatrixXd(residuals->jacobian(Eigen::all, moving));
        return residuals;
    };
    LeastSquaresResult result = minimise_free(of_part, inside(moving), lower(moving), upper(moving), options);
    result.x = whole(result.x);
    return result;
}

} // namespace kluft
