#include "benchmarks.hpp"

#include <exception>

namespace kluft::bench {

void add_benchmark(const std::string& name, const std::function<void(benchmark::State&)>& measure, int samples) {
    const auto told = [measure](benchmark::State& state) {
        try {
            measure(state);
        } catch (const std::exception& error) { // the others go on, and the file of results is closed
            state.SkipWithError(error.what());
        }
    };
    // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): the library owns it
    benchmark::internal::Benchmark* const added = benchmark::RegisterBenchmark(name.c_str(), told);
    added->UseRealTime()->Unit(benchmark::kMillisecond);
    if (samples > 0) added->Iterations(samples);
}

} // namespace kluft::bench
