// Factorization and solution of the body's stiffness.
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "kluft/assembly/linear_solver.hpp"

namespace kluft::bench {

namespace {

/// The stiffness of the body with its factor; made once for all benchmarks.
class FactoredBody {
public:
    explicit FactoredBody(const Body& body) : load_(body.load()) {
        EquilibriumEvaluator evaluator(body.problem(), body.pattern());
        body.stiffness(evaluator, matrix_);
        solver_.analyze(body.pattern());
        factorize(); // the first one also finds the structure of the factor
    }
    void factorize() {
        if (!solver_.factorize(matrix_, Factorization::cholesky)) throw std::runtime_error("the stiffness is singular");
    }
    void solve() { solver_.solve(load_, solution_); }

private:
    LinearSolver solver_;
    BlockMatrix matrix_;
    Eigen::VectorXd load_;
    Eigen::VectorXd solution_;
};

using Operation = void (*)(FactoredBody&);

void refactorize(FactoredBody& body) {
    body.factorize();
    body.solve();
}

void run(benchmark::State& state, FactoredBody& body, Operation operation, int threads) {
    set_blas_threads(threads);
    for (auto _ : state) operation(body);
}

} // namespace

void register_solver_benchmarks(const Body& body, const std::vector<int>& threads) {
    const auto factored = std::make_shared<FactoredBody>(body);
    const std::vector<std::pair<std::string, Operation>> operations{
        {"refactorization", refactorize},
        {"factorization", [](FactoredBody& each) { each.factorize(); }},
        {"solution", [](FactoredBody& each) { each.solve(); }}};
    for (const int n : threads) {
        for (const auto& [name, operation] : operations) {
            benchmark::RegisterBenchmark(
                (name + "/threads:" + std::to_string(n)).c_str(),
                [factored, operation, n](benchmark::State& state) { run(state, *factored, operation, n); })
                ->UseRealTime();
        }
    }
}

} // namespace kluft::bench
