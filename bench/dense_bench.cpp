// The yardstick of the machine: the rate of the BLAS.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "kluft/assembly/blas.hpp"

namespace kluft::bench {

namespace {

void multiply_dense(benchmark::State& state, int threads) {
    constexpr int n = 1000;
    const std::vector<double> a(n * n, 1.0);
    const std::vector<double> b(n * n, 0.5);
    std::vector<double> c(n * n);
    set_blas_threads(threads);
    while (state.KeepRunning()) {
        multiply(n, n, n, a.data(), n, b.data(), n, c.data(), n);
        benchmark::DoNotOptimize(c.data());
    }
    state.counters["flops"] = 2.0 * n * n * n;
}

} // namespace

void register_dense_benchmarks(const std::vector<int>& threads) {
    for (const int n : threads) {
        add_benchmark("dgemm/threads:" + std::to_string(n), [n](benchmark::State& state) { multiply_dense(state, n); });
    }
}

} // namespace kluft::bench
