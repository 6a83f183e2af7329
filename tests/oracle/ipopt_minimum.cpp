#include "oracle/ipopt_minimum.hpp"

#include <algorithm>
#include <stdexcept>

#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>

namespace kluft::oracle {

namespace {

using Ipopt::Index;
using Ipopt::Number;

constexpr double unbounded = 1e20; ///< beyond Ipopt's nlp_upper_bound_inf
constexpr double tolerance = 1e-12;

/// x = length * scaled unknowns, energy = length * force * scaled energy. Conditions: equalities, then inequalities.
class ScaledPotential : public Ipopt::TNLP {
public:
    ScaledPotential(const Potential& potential, const Eigen::VectorXd& guess, const Scales& scales)
        : potential_(potential), guess_(guess / scales.length), scales_(scales) {
        const auto pattern = potential.hessian(guess);
        n_hessian_ = static_cast<Index>(pattern.nonZeros());
        for (const LinearForm* form : forms()) n_jacobian_ += static_cast<Index>(form->terms.size());
    }

    bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag, IndexStyleEnum& index_style) override {
        n = potential_.n_unknowns;
        m = static_cast<Index>(potential_.equalities.size() + potential_.inequalities.size());
        nnz_jac_g = n_jacobian_;
        nnz_h_lag = n_hessian_;
        index_style = C_STYLE;
        return true;
    }

    bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l, Number* g_u) override {
        std::fill_n(x_l, n, -unbounded);
        std::fill_n(x_u, n, unbounded);
        for (const int i : potential_.nonnegative) x_l[i] = 0.0;
        std::fill_n(g_l, m, 0.0);
        const auto n_equalities = potential_.equalities.size();
        for (std::size_t i = 0; i < static_cast<std::size_t>(m); ++i) g_u[i] = i < n_equalities ? 0.0 : unbounded;
        return true;
    }

    bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
        std::copy_n(guess_.data(), n, x);
        return true;
    }

    bool eval_f(Index n, const Number* x, bool, Number& value) override {
        value = potential_.energy(unscaled(n, x)) / (scales_.length * scales_.force);
        return true;
    }

    bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
        Eigen::Map<Eigen::VectorXd>(gradient, n) = potential_.gradient(unscaled(n, x)) / scales_.force;
        return true;
    }

    bool eval_g(Index n, const Number* x, bool, Index, Number* g) override {
        const Eigen::VectorXd position = unscaled(n, x);
        for (const LinearForm* form : forms()) *g++ = form->at(position) / scales_.length;
        return true;
    }

    bool eval_jac_g(Index, const Number*, bool, Index, Index, Index* rows, Index* columns, Number* values) override {
        Index row = 0;
        for (const LinearForm* form : forms()) {
            for (const auto& term : form->terms) {
                if (values != nullptr) {
                    *values++ = term.factor;
                } else {
                    *rows++ = row;
                    *columns++ = term.unknown;
                }
            }
            ++row;
        }
        return true;
    }

    bool eval_h(Index n, const Number* x, bool, Number factor, Index, const Number*, bool, Index, Index* rows,
                Index* columns, Number* values) override {
        const Eigen::SparseMatrix<double> matrix =
            potential_.hessian(x != nullptr ? unscaled(n, x) : Eigen::VectorXd(scales_.length * guess_));
        for (int k = 0; k < matrix.outerSize(); ++k) {
            for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, k); it; ++it) {
                if (values != nullptr) {
                    *values++ = factor * it.value() * scales_.length / scales_.force;
                } else {
                    *rows++ = static_cast<Index>(it.row());
                    *columns++ = static_cast<Index>(it.col());
                }
            }
        }
        return true;
    }

    void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*, const Number*, Index m,
                           const Number*, const Number* lambda, Number, const Ipopt::IpoptData*,
                           Ipopt::IpoptCalculatedQuantities*) override {
        minimum.x = unscaled(n, x);
        // The Lagrangian is f + lambda g: what a condition exerts along its form is -lambda.
        const Eigen::VectorXd forces = -scales_.force * Eigen::Map<const Eigen::VectorXd>(lambda, m);
        const auto n_equalities = static_cast<Eigen::Index>(potential_.equalities.size());
        minimum.equality_forces = forces.head(n_equalities);
        minimum.inequality_forces = forces.tail(m - n_equalities);
    }

    Minimum minimum;

private:
    [[nodiscard]] Eigen::VectorXd unscaled(Index n, const Number* x) const {
        return scales_.length * Eigen::Map<const Eigen::VectorXd>(x, n);
    }
    [[nodiscard]] std::vector<const LinearForm*> forms() const {
        std::vector<const LinearForm*> all;
        for (const LinearForm& form : potential_.equalities) all.push_back(&form);
        for (const LinearForm& form : potential_.inequalities) all.push_back(&form);
        return all;
    }

    const Potential& potential_;
    Eigen::VectorXd guess_; ///< scaled
    Scales scales_;
    Index n_jacobian_ = 0;
    Index n_hessian_ = 0;
};

/// `weight`: of the barrier at the start.
bool set_options(Ipopt::OptionsList& options, double weight) {
    bool known = true;
    const auto text = [&](const char* name, const char* value) {
        known = options.SetStringValue(name, value) && known;
    };
    const auto number = [&](const char* name, double value) { known = options.SetNumericValue(name, value) && known; };
    text("sb", "yes"); // no banner
    known = options.SetIntegerValue("print_level", 0) && known;
    text("linear_solver", "mumps");
    text("nlp_scaling_method", "none");
    text("jac_c_constant", "yes");
    text("jac_d_constant", "yes");
    text("honor_original_bounds", "yes");
    number("bound_relax_factor", 0.0);
    for (const char* const name : {"tol", "dual_inf_tol", "constr_viol_tol", "compl_inf_tol"}) number(name, tolerance);
    number("acceptable_tol", 100.0 * tolerance);
    number("mu_init", weight);
    text("bound_mult_init_method", "mu-based");
    for (const char* const name : {"bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac"})
        number(name, std::min(1e-2, weight));
    known = options.SetIntegerValue("max_iter", 500) && known;
    return known;
}

} // namespace

Minimum minimise(const Potential& potential, const Eigen::VectorXd& guess, const Scales& scales, double weight) {
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
    if (!set_options(*application->Options(), weight) ||
        application->Initialize("") != Ipopt::Solve_Succeeded) // "": no file of options
        throw std::runtime_error("Ipopt does not know its options");
    const Ipopt::SmartPtr<ScaledPotential> problem = new ScaledPotential(potential, guess, scales);
    const auto status = application->OptimizeTNLP(Ipopt::GetRawPtr(problem));
    Minimum minimum = problem->minimum;
    minimum.converged = status == Ipopt::Solve_Succeeded || status == Ipopt::Solved_To_Acceptable_Level;
    minimum.status = std::to_string(static_cast<int>(status));
    if (Ipopt::IsValid(application->Statistics())) minimum.iterations = application->Statistics()->IterationCount();
    return minimum;
}

} // namespace kluft::oracle
