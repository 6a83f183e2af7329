#include "kluft/assembly/block_supernodes.hpp"

#include <algorithm>

namespace kluft {

namespace {

/// Neighbours of a block that are eliminated before it: calls f(position).
template <class F>
void for_each_earlier(const BlockPattern& pattern, const std::vector<int>& position, int block, F f) {
    for (int entry = pattern.row_start(block); entry < pattern.row_start(block + 1); ++entry) {
        const int p = position[pattern.column(entry)];
        if (p < position[block]) f(p);
    }
}

/// Elimination tree (Liu 1986), with paths to the roots shortened on the way.
std::vector<int> elimination_tree(const BlockPattern& pattern, const std::vector<int>& position,
                                  const std::vector<int>& block_at) {
    const int n = pattern.n_blocks();
    std::vector<int> parent(n, -1);
    std::vector<int> ancestor(n, -1);
    for (int p = 0; p < n; ++p) {
        for_each_earlier(pattern, position, block_at[p], [&](int j) {
            while (ancestor[j] >= 0 && ancestor[j] != p) {
                const int next = ancestor[j];
                ancestor[j] = p;
                j = next;
            }
            if (ancestor[j] < 0) {
                ancestor[j] = p;
                parent[j] = p;
            }
        });
    }
    return parent;
}

/// Blocks in each column of L, the diagonal included: a row of L is a part of the tree, below that row.
std::vector<int> column_counts(const BlockPattern& pattern, const std::vector<int>& position,
                               const std::vector<int>& block_at, const std::vector<int>& parent) {
    const int n = pattern.n_blocks();
    std::vector<int> counts(n, 1);
    std::vector<int> seen_in_row(n, -1);
    for (int p = 0; p < n; ++p) {
        seen_in_row[p] = p;
        for_each_earlier(pattern, position, block_at[p], [&](int j) {
            for (; seen_in_row[j] != p; j = parent[j]) {
                ++counts[j];
                seen_in_row[j] = p;
            }
        });
    }
    return counts;
}

/// A run of columns and the blocks stored for them.
struct Group {
    int first = 0;
    int n_columns = 0;
    int n_rows = 0; ///< its columns included
    double zeros = 0.0;

    [[nodiscard]] double stored() const { return n_columns * (n_rows - 0.5 * (n_columns - 1)); }
};

Group joined(const Group& child, const Group& parent) {
    Group both{.first = child.first,
               .n_columns = child.n_columns + parent.n_columns,
               .n_rows = child.n_columns + parent.n_rows};
    both.zeros = child.zeros + parent.zeros + static_cast<double>(child.n_columns) * (both.n_rows - child.n_rows);
    return both;
}

/// Narrow fronts cost more than their operations; limits found by trial.
bool worth_joining(const Group& both, int nu) {
    struct Limit {
        int columns;
        double zeros;
    };
    constexpr Limit limits[] = {{12, 1.0}, {24, 0.6}, {48, 0.2}, {96, 0.08}};
    const double share = both.zeros / both.stored();
    for (const Limit& limit : limits) {
        if (nu * both.n_columns <= limit.columns && share <= limit.zeros) return true;
    }
    return share <= 0.04;
}

/// Runs of columns, ascending: those with the same rows below, and children joined to the parent that follows them.
std::vector<Group> groups_of(const std::vector<int>& parent, const std::vector<int>& counts, int nu) {
    const int n = static_cast<int>(parent.size());
    std::vector<int> n_children(n, 0);
    for (const int p : parent) {
        if (p >= 0) ++n_children[p];
    }
    std::vector<Group> groups; // from the last column to the first
    for (int j = n - 1; j >= 0; --j) {
        Group own{.first = j, .n_columns = 1, .n_rows = counts[j]};
        // Columns with the same rows are found before their zeros are weighed.
        while (j > 0 && parent[j - 1] == j && n_children[j] == 1 && counts[j - 1] == counts[j] + 1) {
            --j;
            own = {.first = j, .n_columns = own.n_columns + 1, .n_rows = counts[j]};
        }
        while (!groups.empty()) {
            const Group& next = groups.back();
            const int last = own.first + own.n_columns - 1;
            if (parent[last] < next.first || parent[last] >= next.first + next.n_columns) break;
            const Group both = joined(own, next);
            if (!worth_joining(both, nu)) break;
            groups.pop_back();
            own = both;
        }
        groups.push_back(own);
    }
    std::ranges::reverse(groups);
    return groups;
}

/// Rows below each supernode: those of the matrix and of the children.
void find_rows(const BlockPattern& pattern, const std::vector<int>& position, const std::vector<int>& block_at,
               BlockSupernodes& s) {
    const int n_supernodes = s.size();
    std::vector<int> supernode_of(block_at.size());
    for (int k = 0; k < n_supernodes; ++k) {
        std::fill(supernode_of.begin() + s.first_block[k], supernode_of.begin() + s.first_block[k + 1], k);
    }
    std::vector<int> seen_by(block_at.size(), -1);
    std::vector<int> first_child(n_supernodes, -1);
    std::vector<int> next_child(n_supernodes, -1);
    s.row_starts.assign(1, 0);
    for (int k = 0; k < n_supernodes; ++k) {
        const int end = s.first_block[k + 1];
        const auto add = [&](int row) {
            if (row < end || seen_by[row] == k) return;
            seen_by[row] = k;
            s.rows.push_back(row);
        };
        for (int p = s.first_block[k]; p < end; ++p) {
            const int b = block_at[p];
            for (int entry = pattern.row_start(b); entry < pattern.row_start(b + 1); ++entry)
                add(position[pattern.column(entry)]);
        }
        for (int child = first_child[k]; child >= 0; child = next_child[child]) {
            for (std::int64_t i = s.row_starts[child]; i < s.row_starts[child + 1]; ++i) add(s.rows[i]);
        }
        std::sort(s.rows.begin() + s.row_starts[k], s.rows.end());
        s.row_starts.push_back(static_cast<std::int64_t>(s.rows.size()));
        if (s.rows_below(k).empty()) continue;
        const int parent = supernode_of[s.rows_below(k).front()];
        s.parent[k] = parent;
        next_child[k] = first_child[parent];
        first_child[parent] = k;
    }
}

} // namespace

BlockSupernodes block_supernodes(const BlockPattern& pattern, const std::vector<int>& position) {
    std::vector<int> block_at(position.size());
    for (std::size_t b = 0; b < position.size(); ++b) block_at[position[b]] = static_cast<int>(b);
    BlockSupernodes s;
    s.nu = pattern.block_unknowns();
    const std::vector<int> parent = elimination_tree(pattern, position, block_at);
    const std::vector<int> counts = column_counts(pattern, position, block_at, parent);
    for (const int count : counts) {
        for (int j = 0; j < s.nu; ++j) {
            const double length = static_cast<double>(s.nu) * count - j;
            s.nonzeros += length;
            s.flops += length * length;
        }
    }
    for (const Group& group : groups_of(parent, counts, s.nu)) s.first_block.push_back(group.first);
    s.parent.assign(s.first_block.size(), -1);
    s.first_block.push_back(pattern.n_blocks());
    find_rows(pattern, position, block_at, s);
    s.value_starts.assign(1, 0);
    for (int k = 0; k < s.size(); ++k) {
        const std::int64_t n_rows = s.n_columns(k) + s.n_below(k);
        s.value_starts.push_back(s.value_starts.back() + n_rows * s.n_columns(k));
    }
    return s;
}

} // namespace kluft
