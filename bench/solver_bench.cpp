// Factorization and solution of the body's stiffness.
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "kluft/assembly/blas.hpp"

namespace kluft::bench {

namespace {

using Operation = void (*)(FactoredBody&);

void refactorize(FactoredBody& body) {
    body.factorize();
    body.solve();
}

void run(benchmark::State& state, FactoredBody& body, Operation operation, int threads) {
    set_blas_threads(threads);
    body.restore();
    while (state.KeepRunning()) operation(body);
}

} // namespace

void register_solver_benchmarks(FactoredBody& body, const std::vector<int>& threads) {
    const std::vector<std::pair<std::string, Operation>> operations{
        {"refactorization", refactorize},
        {"factorization", [](FactoredBody& each) { each.factorize(); }},
        {"solution", [](FactoredBody& each) { each.solve(); }}};
    for (const int n : threads) {
        for (const auto& [name, operation] : operations) {
            add_benchmark(name + "/threads:" + std::to_string(n),
                          [&body, operate = operation, n](benchmark::State& state) { run(state, body, operate, n); });
        }
    }
}

} // namespace kluft::bench
