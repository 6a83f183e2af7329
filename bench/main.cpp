// Benchmarks of one scene; scripts/bench runs them for several sizes and makes the table.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "benchmarks.hpp"
#include "kluft/assembly/linear_solver.hpp"

namespace {

using namespace kluft;

void describe(const bench::Body& body) {
    const FactorCost cost = factor_cost(body.pattern(), Factorization::rounded_cholesky);
    benchmark::AddCustomContext("blocks", std::to_string(body.model().system.n_blocks()));
    benchmark::AddCustomContext("interfaces", std::to_string(body.model().system.n_interfaces()));
    benchmark::AddCustomContext("factor_flops", fmt::format("{:.17g}", cost.flops));
    benchmark::AddCustomContext("factor_bytes", fmt::format("{:.17g}", cost.bytes));
}

int run_benchmarks(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    CLI::App app{"Benchmarks of the body of a scene. Options --benchmark_... are those of Google Benchmark."};
    std::string scene;
    std::vector<std::string> overrides;
    std::vector<int> threads{1};
    app.add_option("SCENE", scene, "Scene file")->required();
    app.add_option("--set", overrides, "Override a value of the scene")->allow_extra_args(false);
    app.add_option("--threads", threads, "Threads of the BLAS, e.g. 1,2; updates run with the first")
        ->delimiter(',')
        ->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);

    const Model model = bench::read_model(scene, overrides);
    const bench::Body body(model, bench::Joining::bonded);
    describe(body);
    bench::register_dense_benchmarks(threads);
    bench::register_assembly_benchmarks(body);
    bench::FactoredBody factored(body);
    bench::register_solver_benchmarks(factored, threads);
    bench::register_update_benchmarks(factored, threads.front());
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run_benchmarks(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
