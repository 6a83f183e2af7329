// Tangent and residual of the whole body.
#include <benchmark/benchmark.h>

#include "benchmarks.hpp"

namespace kluft::bench {

namespace {

void assemble_tangent(benchmark::State& state, const Body& body) {
    EquilibriumEvaluator evaluator(body.problem(), body.pattern());
    BlockMatrix matrix;
    evaluator.tangent(body.displacement(), TangentKind::symmetric, matrix); // the first one allocates
    while (state.KeepRunning()) {
        evaluator.tangent(body.displacement(), TangentKind::symmetric, matrix);
        benchmark::DoNotOptimize(matrix.values.data());
    }
}

void assemble_fractured_tangent(benchmark::State& state, const Body& bonded) {
    const Body body(bonded.model(), Joining::fractured);
    assemble_tangent(state, body);
}

void evaluate_residual(benchmark::State& state, const Body& body) {
    EquilibriumEvaluator evaluator(body.problem(), body.pattern());
    Residual residual;
    evaluator.residual(body.displacement(), residual);
    while (state.KeepRunning()) {
        evaluator.residual(body.displacement(), residual);
        benchmark::DoNotOptimize(residual.forces.data());
    }
}

} // namespace

void register_assembly_benchmarks(const Body& body) {
    add_benchmark("tangent", [&body](benchmark::State& state) { assemble_tangent(state, body); });
    add_benchmark("fractured_tangent", [&body](benchmark::State& state) { assemble_fractured_tangent(state, body); });
    add_benchmark("residual", [&body](benchmark::State& state) { evaluate_residual(state, body); });
}

} // namespace kluft::bench
