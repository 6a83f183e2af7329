// The benchmarks of one body, by name; scripts/bench makes the table of their ratios.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "factored_body.hpp"

namespace kluft::bench {

/// Adds one benchmark to those of the program. `samples`: measured runs per repetition; 0 leaves it to the library.
void add_benchmark(const std::string& name, const std::function<void(benchmark::State&)>& measure, int samples = 0);

/// dgemm/threads:N, two matrices of 1000 x 1000; the counter `flops` is the number of operations.
void register_dense_benchmarks(const std::vector<int>& threads);

/// tangent and residual of the body, fractured_tangent of the same body with every interface failed.
void register_assembly_benchmarks(const Body& body);

/// refactorization/threads:N (factorization and solution), factorization/threads:N and solution/threads:N.
void register_solver_benchmarks(FactoredBody& body, const std::vector<int>& threads);

/// path_set_up/10/PLACEMENT, iteration/N/PLACEMENT, frictional_iteration/N/PLACEMENT (the tangent is unsymmetric, the
/// changes of the factor are not) and load_step/PLACEMENT for N = 10 or 100 changed points that are spread over the
/// body or, in bodies of up to 100 000 blocks, also lie in a line.
void register_update_benchmarks(FactoredBody& body, int threads);

} // namespace kluft::bench
