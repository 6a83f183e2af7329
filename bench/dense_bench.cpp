// The yardstick of the machine: the rate of the BLAS.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "kluft/assembly/linear_solver.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): of the BLAS
extern "C" void dgemm_(const char* trans_a, const char* trans_b, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

namespace kluft::bench {

namespace {

void multiply_dense(benchmark::State& state, int threads) {
    constexpr int n = 1000;
    constexpr double zero = 0.0;
    constexpr double one = 1.0;
    const std::vector<double> a(n * n, 1.0);
    const std::vector<double> b(n * n, 0.5);
    std::vector<double> c(n * n);
    set_blas_threads(threads);
    for (auto _ : state) {
        dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
        benchmark::DoNotOptimize(c.data());
    }
    state.counters["flops"] = 2.0 * n * n * n;
}

} // namespace

void register_dense_benchmarks(const std::vector<int>& threads) {
    for (const int n : threads) {
        benchmark::RegisterBenchmark(("dgemm/threads:" + std::to_string(n)).c_str(), multiply_dense, n)->UseRealTime();
    }
}

} // namespace kluft::bench
