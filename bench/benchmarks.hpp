// The benchmarks of one body, by name. Times are wall-clock times; the table is made of their ratios.
#pragma once

#include <vector>

#include "body.hpp"

namespace kluft::bench {

/// dgemm/threads:N, two matrices of 1000 x 1000; items are floating-point operations.
void register_dense_benchmarks(const std::vector<int>& threads);

/// tangent, residual, evaluator/KIND and fractured_tangent/KIND of the body and of the same with every interface failed.
void register_assembly_benchmarks(const Body& body);

/// refactorization/threads:N (factorization and solution), factorization/threads:N, solution/threads:N.
void register_solver_benchmarks(const Body& body, const std::vector<int>& threads);

} // namespace kluft::bench
