#include "benchmarks.hpp"

namespace kluft::bench {

void add_benchmark(const std::string& name, const std::function<void(benchmark::State&)>& measure, int samples) {
    // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): the library owns it
    benchmark::internal::Benchmark* const added = benchmark::RegisterBenchmark(name.c_str(), measure);
    added->UseRealTime()->Unit(benchmark::kMillisecond);
    if (samples > 0) added->Iterations(samples);
}

} // namespace kluft::bench
