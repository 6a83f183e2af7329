// Sets of numbers that are joined pair by pair (union-find).
#pragma once

#include <numeric>
#include <vector>

namespace kluft {

class DisjointSets {
public:
    /// The numbers from 0 to n - 1, each alone.
    explicit DisjointSets(int n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
    /// The member that names the set of `i`.
    int root(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// Makes the sets of both one.
    void join(int a, int b) { parent_[root(a)] = root(b); }

private:
    std::vector<int> parent_;
};

} // namespace kluft
