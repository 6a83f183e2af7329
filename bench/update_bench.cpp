// Iterations of a load step after the changes of some contact points, with the factor of the step's start.
#include <array>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "changed_points.hpp"
#include "kluft/assembly/blas.hpp"
#include "kluft/contact/bonds.hpp"

namespace kluft::bench {

namespace {

constexpr int iterations_of_step = 6;
constexpr int points_per_iteration = 30;
constexpr int many_blocks = 100'000; ///< a factor takes half a minute

/// Changes since the factor was made.
struct Changes {
    Sliding sliding;
    std::vector<StiffnessChange> in_factor; ///< what is put on it: symmetric
    std::vector<StiffnessChange> in_matrix; ///< what the tangent has; of friction it is unsymmetric
};

/// The factor of the unchanged body, outside the measurement: no path has been solved on it.
void renew_factor(benchmark::State& state, FactoredBody& body) {
    state.PauseTiming();
    body.restore();
    state.ResumeTiming();
}

/// Puts the changes on the factor, or factorizes where there are too many. True if it did the latter.
bool follow(FactoredBody& body, std::span<const StiffnessChange> changes) {
    if (body.update(changes)) return false;
    body.factorize();
    return true;
}

/// Per sample. Zeros are left out: over several repetitions their coefficient of variation is NaN, which JSON does not know.
void report(benchmark::State& state, const char* name, int n) {
    if (n == 0) return;
    state.counters[name] = benchmark::Counter(n, benchmark::Counter::kAvgIterations);
}

void set_up_paths(benchmark::State& state, FactoredBody& body, const Changes& changes) {
    while (state.KeepRunning()) {
        renew_factor(state, body);
        benchmark::DoNotOptimize(follow(body, changes.in_factor));
    }
}

void iterate(benchmark::State& state, FactoredBody& body, const Changes& changes) {
    int factorizations = 0;
    int refinements = 0;
    while (state.KeepRunning()) {
        renew_factor(state, body);
        const bool updated = body.update(changes.in_factor);
        if (!updated) { // Cholesky's method takes no tangent of friction
            body.assemble(changes.in_factor);
            body.factorize();
            ++factorizations;
        }
        if (updated || changes.sliding == Sliding::frictional) body.assemble(changes.in_matrix);
        refinements += body.solve_refined();
    }
    report(state, "factorizations", factorizations);
    report(state, "refinements", refinements);
}

/// A factorization, then iterations with more and more changed points.
void load_step(benchmark::State& state, FactoredBody& body, const Changes& changes) {
    int factorizations = 0;
    int refinements = 0;
    const std::span<const StiffnessChange> in_factor(changes.in_factor);
    const std::span<const StiffnessChange> in_matrix(changes.in_matrix);
    const std::size_t more = points_per_iteration / n_bond_points;
    while (state.KeepRunning()) {
        body.assemble();
        body.factorize();
        ++factorizations;
        std::size_t factorized = 0;
        for (std::size_t now = more; now <= in_factor.size(); now += more) {
            body.assemble(in_matrix.first(now));
            if (follow(body, in_factor.subspan(factorized, now - factorized))) {
                ++factorizations;
                factorized = now;
            }
            refinements += body.solve_refined();
        }
    }
    report(state, "factorizations", factorizations);
    report(state, "refinements", refinements);
}

using Measurement = void (*)(benchmark::State&, FactoredBody&, const Changes&);

struct UpdateBenchmark {
    const char* name;
    Measurement measure;
    int points;
    Sliding sliding;
};

constexpr std::array update_benchmarks{
    UpdateBenchmark{"path_set_up/10", set_up_paths, 10, Sliding::frictionless},
    UpdateBenchmark{"iteration/10", iterate, 10, Sliding::frictionless},
    UpdateBenchmark{"iteration/100", iterate, 100, Sliding::frictionless},
    UpdateBenchmark{"frictional_iteration/10", iterate, 10, Sliding::frictional},
    UpdateBenchmark{"frictional_iteration/100", iterate, 100, Sliding::frictional},
    UpdateBenchmark{"load_step", load_step, iterations_of_step* points_per_iteration, Sliding::frictionless}};

/// Each sample needs a new factor.
int samples(int n_blocks) { return n_blocks < 10'000 ? 5 : 1; }

void add_placement(FactoredBody& body, Placement placement, const std::string& suffix, int threads) {
    for (const auto& [name, measure, points, sliding] : update_benchmarks) {
        const int interfaces = points / n_bond_points;
        const Changes changes{sliding, changed_interfaces(body.body(), placement, interfaces, Sliding::frictionless),
                              changed_interfaces(body.body(), placement, interfaces, sliding)};
        if (static_cast<int>(changes.in_factor.size()) < interfaces) continue; // the body is too small
        const auto run = [measure = measure, &body, changes, threads](benchmark::State& state) {
            set_blas_threads(threads);
            measure(state, body, changes);
        };
        add_benchmark(name + suffix, run, samples(body.body().model().system.n_blocks()));
    }
}

} // namespace

void register_update_benchmarks(FactoredBody& body, int threads) {
    add_placement(body, Placement::spread, "/spread", threads);
    if (body.body().model().system.n_blocks() < many_blocks) add_placement(body, Placement::line, "/line", threads);
}

} // namespace kluft::bench
