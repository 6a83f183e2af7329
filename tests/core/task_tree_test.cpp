#include "kluft/core/task_tree.hpp"

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

/// A binary tree numbered in postorder, as heaps are in the other direction.
std::vector<int> binary_tree(int n) {
    std::vector<int> parent(n, -1);
    for (int i = 1; i < n; ++i) parent[n - 1 - i] = n - 1 - (i - 1) / 2;
    return parent;
}

class TaskTreeWith : public ::testing::TestWithParam<int> {};

TEST_P(TaskTreeWith, DoesEachTaskOnceAndAfterItsChildren) {
    const std::vector<int> parent = binary_tree(301);
    std::vector<std::atomic<int>> done(parent.size());
    std::atomic<bool> in_order = true;
    TaskTree tree(parent);
    tree.run(GetParam(), [&](int task, int thread) {
        if (thread < 0 || thread >= GetParam()) in_order = false;
        for (std::size_t child = 0; child < parent.size(); ++child) {
            if (parent[child] == task && done[child] != 1) in_order = false;
        }
        ++done[task];
    });
    EXPECT_TRUE(in_order);
    for (const auto& times : done) EXPECT_EQ(times, 1);
}

TEST_P(TaskTreeWith, SharesALoopWithoutLeavingOutOrRepeatingAnything) {
    TaskTree tree(binary_tree(15));
    std::atomic<int> wrong = 0;
    tree.run(GetParam(), [&](int, int) {
        std::vector<std::atomic<int>> times(100);
        tree.share(100, [&](int i) { ++times[i]; });
        for (const auto& each : times) wrong += each != 1 ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0);
}

TEST_P(TaskTreeWith, ThrowsWhatATaskHasThrownAndBeginsNoOther) {
    const std::vector<int> parent = binary_tree(31);
    TaskTree tree(parent);
    std::atomic<bool> root_was_done = false;
    const auto task = [&](int number, int) {
        if (number == 3) throw std::runtime_error("no memory");
        if (parent[number] < 0) root_was_done = true;
    };
    EXPECT_THROW(tree.run(GetParam(), task), std::runtime_error);
    EXPECT_FALSE(root_was_done);
}

TEST_P(TaskTreeWith, StopsWhereATaskFindsAllInVain) {
    const std::vector<int> parent = binary_tree(31);
    TaskTree tree(parent);
    std::atomic<bool> root_was_done = false;
    tree.run(GetParam(), [&](int number, int) {
        if (number == 5) tree.stop();
        if (parent[number] < 0) root_was_done = true;
    });
    EXPECT_FALSE(root_was_done);
}

INSTANTIATE_TEST_SUITE_P(Threads, TaskTreeWith, ::testing::Values(1, 2, 3, 7));

} // namespace
} // namespace kluft
