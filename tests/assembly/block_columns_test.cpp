#include "kluft/assembly/block_columns.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

std::atomic<int> n_terminations{0};

BlockPattern banded_graph(int n) {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i + 1 < n; ++i) pairs.emplace_back(i, i + 1);
    for (int i = 0; i + 7 < n; ++i) pairs.emplace_back(i, i + 7);
    return {n, pairs};
}

TEST(EliminationOrder, IsAPermutation) {
    auto position = elimination_order(banded_graph(500));
    std::sort(position.begin(), position.end());
    std::vector<int> all(500);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(position, all);
}

// METIS has a handler of its own for SIGTERM while it works, and reports what it caught as a lack of memory.
TEST(EliminationOrder, IsNotDisturbedByATermination) {
    n_terminations = 0;
    const auto before = std::signal(SIGTERM, [](int) { ++n_terminations; });
    const auto undisturbed = elimination_order(banded_graph(3000));
    const pthread_t here = pthread_self();
    std::atomic<bool> ended{false};
    std::thread disturber([&] {
        while (!ended) pthread_sigqueue(here, SIGTERM, sigval{});
    });
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(elimination_order(banded_graph(3000)), undisturbed);
    }
    ended = true;
    disturber.join();
    std::signal(SIGTERM, before);
    EXPECT_GE(n_terminations, 5); // each came after the ordering during which it was sent
}

} // namespace
} // namespace kluft
