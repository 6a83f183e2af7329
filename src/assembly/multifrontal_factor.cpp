#include "kluft/assembly/multifrontal_factor.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include "kluft/assembly/blas.hpp"
#include "kluft/assembly/front.hpp"
#include "kluft/assembly/rounded_supernode.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"
#include "kluft/core/task_tree.hpp"

namespace kluft {

namespace {

constexpr double branch_share = 1.0 / 96.0; ///< of all operations, at most, in a branch that is one task

/// Of the rounding of single precision, times the root of the number of unknowns eliminated before: below this share of its
/// diagonal entry a pivot cannot be told from zero. A body of hexagons that is free to move sideways has a last pivot
/// of 1.3e-3, in which there was an error of 6e-4 at 300 000 unknowns and a larger one than itself at 1.2 million.
constexpr double pivot_noise = 64.0 * 6e-8;
constexpr double least_pivot_share = 1e-5; ///< the same where little has been eliminated
constexpr int max_raised = 6;              ///< two bodies that are free to move

constexpr std::size_t unknowns_worth_threads = 20'000; ///< for less starting them takes longer
constexpr int assembled_columns = 384;                 ///< of a front, that are added to its parent together

using Room = std::unique_ptr<float[]>; // NOLINT(modernize-avoid-c-arrays)

Room room_for(std::size_t n) {
    Room room(new float[n]); // left unset
    prefer_huge_pages(room.get(), sizeof(float) * n);
    return room;
}

/// The matrix is scaled by these numbers between one and two while it is factorized. Bodies of equal blocks have equal entries, and
/// their equal roundings would add up over the body instead of cancelling.
double scale_of(std::int64_t unknown) {
    constexpr double golden_section = 0.6180339887498949; // its multiples are spread evenly
    const double multiple = golden_section * static_cast<double>(unknown);
    return 1.0 + (multiple - std::floor(multiple));
}

std::size_t square(int n) { return static_cast<std::size_t>(n) * static_cast<std::size_t>(n); }

using Stacks = std::array<Room, 2>;

/// Rooms that pass from one thread to another, each used again where it fits.
class Rooms {
public:
    struct Piece {
        Room room;
        std::size_t size = 0;
    };

    Piece take(std::size_t n) {
        const std::lock_guard lock(mutex_);
        const auto fitting =
            std::ranges::find_if(free_, [&](const Piece& piece) { return piece.size >= n && piece.size <= n + n / 2; });
        if (fitting != free_.end()) {
            Piece piece = std::move(*fitting);
            free_.erase(fitting);
            return piece;
        }
        free_.clear(); // others are not kept beside a new one
        return {room_for(n), n};
    }
    void give_back(Piece piece) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(piece));
    }

private:
    std::vector<Piece> free_;
    std::mutex mutex_;
};

/// Rows of a child in the front of its parent, by runs of consecutive ones.
struct Run {
    int from = 0;
    int to = 0;
    int length = 0;
};

std::vector<Run> runs_in_parent(const BlockSupernodes& s, int child, int parent) {
    std::vector<Run> runs;
    const auto rows = s.rows_below(child);
    const auto parent_rows = s.rows_below(parent);
    std::size_t next = 0; // of the parent's rows
    for (std::size_t i = 0; i < rows.size(); ++i) {
        int to = rows[i] - s.first_block[parent];
        if (rows[i] >= s.first_block[parent + 1]) {
            while (parent_rows[next] != rows[i]) ++next;
            to = s.n_blocks(parent) + static_cast<int>(next);
        }
        if (!runs.empty() && runs.back().to + runs.back().length == s.nu * to) {
            runs.back().length += s.nu;
        } else {
            runs.push_back({s.nu * static_cast<int>(i), s.nu * to, s.nu});
        }
    }
    return runs;
}

/// Adds columns first to last - 1 of what a child has left, n x n, to a triangle of the front of its parent.
void add_columns(const std::vector<Run>& runs, const float* left, int n, int first, int last, const Front& front,
                 const FrontTriangle& triangle) {
    const int n_rows = front.n_rows();
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (int c = std::max(first, runs[r].from); c < std::min(last, runs[r].from + runs[r].length); ++c) {
            const float* const from = left + static_cast<std::size_t>(n) * c;
            const int column = runs[r].to + (c - runs[r].from);
            float* const to = column < front.n_columns
                                  ? triangle.columns + static_cast<std::size_t>(n_rows) * column
                                  : triangle.rest +
                                        static_cast<std::size_t>(front.n_below) * (column - front.n_columns) -
                                        front.n_columns;
            for (std::size_t q = r; q < runs.size(); ++q) {
                const int skipped = q == r ? c - runs[r].from : 0;
                const float* const source = from + runs[q].from;
                float* const target = to + runs[q].to;
                for (int i = skipped; i < runs[q].length; ++i) target[i] += source[i];
            }
        }
    }
}

} // namespace

/// The numbers of one factorization.
struct MultifrontalFactor::Numbers {
    Numbers(const MultifrontalFactor& factor, const BlockMatrix& matrix_to_read, float* values_of_l, float* values_of_u)
        : f(factor), s(factor.supernodes_), matrix(matrix_to_read), values(values_of_l), upper_values(values_of_u),
          passed_on(factor.supernodes_.size()), tree(factor.plan_.task_parent) {}

    const MultifrontalFactor& f;
    const BlockSupernodes& s;
    const BlockMatrix& matrix;
    float* values;
    float* upper_values;                 ///< nullptr for L L'
    std::vector<Rooms::Piece> passed_on; ///< what the last supernode of a task has left to its parent
    Rooms rooms;
    TaskTree tree;
    std::atomic<bool> regular = true;
    std::atomic<int> n_raised = 0;

    [[nodiscard]] bool is_symmetric() const { return upper_values == nullptr; }
    [[nodiscard]] std::size_t n_triangles() const { return is_symmetric() ? 1 : 2; }

    /// Adds the entries of the columns of a supernode to a triangle: value(row, column) of the lower one, those of the
    /// transposed matrix of the upper one.
    template <int nu, class Value> void add_entries(int k, float* columns, const Value& value) {
        const BlockPattern& pattern = *matrix.pattern;
        const int n_rows = s.n_columns(k) + s.n_below(k);
        const auto below = s.rows_below(k);
        for (int j = 0; j < s.n_blocks(k); ++j) {
            const int p = s.first_block[k] + j;
            const int b = f.block_at_[p];
            std::array<double, nu> own_scales{};
            for (int c = 0; c < nu; ++c) own_scales[c] = scale_of(static_cast<std::int64_t>(nu) * p + c);
            for (int entry = pattern.row_start(b); entry < pattern.row_start(b + 1); ++entry) {
                const int row = f.position_[pattern.column(entry)];
                if (row < p) continue;
                int to = row - s.first_block[k];
                if (row >= s.first_block[k + 1])
                    to = s.n_blocks(k) + static_cast<int>(std::ranges::lower_bound(below, row) - below.begin());
                std::array<double, nu> row_scales{};
                for (int i = 0; i < nu; ++i) row_scales[i] = scale_of(static_cast<std::int64_t>(nu) * row + i);
                const auto block = value(b, entry);
                for (int c = 0; c < nu; ++c) {
                    float* const column = columns + static_cast<std::size_t>(n_rows) * (nu * j + c) + nu * to;
                    for (int i = 0; i < nu; ++i)
                        column[i] = static_cast<float>(own_scales[c] * row_scales[i] * block(i, c));
                }
            }
        }
    }

    /// The entries of the matrix in both triangles of a front, or in the lower one of a symmetric matrix.
    template <int nu, class Entries> void add_entries(int k, const Entries& entries, const Front& own) {
        const BlockPattern& pattern = *matrix.pattern;
        const auto transposed = [&](int, int entry) { return entries[entry].transpose(); };
        if (is_symmetric()) return add_entries<nu>(k, own.lower.columns, transposed);
        add_entries<nu>(k, own.upper.columns, transposed);
        add_entries<nu>(
            k, own.lower.columns, [&](int b, int entry) -> const auto& {
                return entries[pattern.find(pattern.column(entry), b)];
            });
    }

    template <int nu, class Entries>
    void set_least_pivots(int k, const Entries& entries, std::vector<float>& least_pivots) const {
        least_pivots.clear();
        for (int p = s.first_block[k]; p < s.first_block[k + 1]; ++p) {
            const auto& own = entries[matrix.pattern->diagonal(f.block_at_[p])];
            for (int c = 0; c < nu; ++c) {
                const double scale = scale_of(static_cast<std::int64_t>(nu) * p + c);
                const double diagonal = is_symmetric() ? own(c, c) : std::abs(own(c, c));
                least_pivots.push_back(static_cast<float>(f.plan_.least_ratio[k] * (scale * scale) * diagonal));
            }
        }
    }

    /// Its triangles with zeros; `rest` has room for what it leaves in each of them.
    [[nodiscard]] Front empty_front(int k, float* rest) const {
        Front own{.n_columns = s.n_columns(k), .n_below = s.n_below(k)};
        const auto cleared = [&](float* of_l_or_u, float* room) {
            float* const columns = of_l_or_u + s.value_starts[k];
            std::fill_n(columns, static_cast<std::size_t>(own.n_rows()) * own.n_columns, 0.0F);
            std::fill_n(room, square(own.n_below), 0.0F);
            return FrontTriangle{columns, room};
        };
        own.lower = cleared(values, rest);
        if (!is_symmetric()) own.upper = cleared(upper_values, rest + square(own.n_below));
        return own;
    }

    /// Rows of L and of the transposed U without the scale; `inverses` is room.
    void take_scale_off(int k, const Front& front, std::vector<float>& inverses) const {
        inverses.clear();
        const auto add = [&](int block) {
            for (int i = 0; i < s.nu; ++i)
                inverses.push_back(static_cast<float>(1.0 / scale_of(static_cast<std::int64_t>(s.nu) * block + i)));
        };
        for (int block = s.first_block[k]; block < s.first_block[k + 1]; ++block) add(block);
        for (const int block : s.rows_below(k)) add(block);
        const std::size_t n_rows = inverses.size();
        for (float* const columns : {front.lower.columns, front.upper.columns}) {
            if (columns == nullptr) continue;
            for (int j = 0; j < front.n_columns; ++j) {
                float* const column = columns + n_rows * j;
                for (std::size_t i = j; i < n_rows; ++i) column[i] *= inverses[i];
            }
        }
    }

    /// False if there are pivots that are none. `rest` has room for what the front leaves; left(child) is what a child has
    /// left.
    template <class Left>
    bool eliminate(int k, float* rest, const Left& left, const Sharing& share, std::vector<float>& least_pivots) {
        Front own = empty_front(k, rest);
        if (matrix.is_rigid()) {
            add_entries<n_rigid_unknowns>(k, matrix.rigid_values, own);
            set_least_pivots<n_rigid_unknowns>(k, matrix.rigid_values, least_pivots);
        } else {
            add_entries<n_block_unknowns>(k, matrix.values, own);
            set_least_pivots<n_block_unknowns>(k, matrix.values, least_pivots);
        }
        for (int child = f.plan_.first_child[k]; child >= 0; child = f.plan_.next_child[child]) {
            const std::vector<Run> runs = runs_in_parent(s, child, k);
            const int n = s.n_below(child);
            share((n + assembled_columns - 1) / assembled_columns, [&](int i) {
                const int first = i * assembled_columns;
                const int last = std::min(n, first + assembled_columns);
                add_columns(runs, left(child), n, first, last, own, own.lower);
                if (!is_symmetric()) add_columns(runs, left(child) + square(n), n, first, last, own, own.upper);
            });
        }
        own.least_pivots = least_pivots.data();
        const std::optional<int> raised = kluft::factorize(own, share);
        if (raised) take_scale_off(k, own, least_pivots);
        return raised && (n_raised += *raised) <= max_raised;
    }

    void do_task(int t, Stacks& stacks, std::vector<float>& least_pivots) {
        const int first = f.plan_.tasks[t].first;
        const int last = f.plan_.tasks[t].last;
        const Sharing alone = [](int n, const std::function<void(int)>& body) {
            for (int i = 0; i < n; ++i) body(i);
        };
        const Sharing together = [&](int n, const std::function<void(int)>& body) { tree.share(n, body); };
        for (int k = first; k <= last; ++k) {
            const auto left = [&](int child) -> const float* {
                if (child < first) return passed_on[child].room.get();
                return stacks[f.plan_.stack[child]].get() + n_triangles() * f.plan_.place[child];
            };
            float* rest = stacks[f.plan_.stack[k]].get() + n_triangles() * f.plan_.place[k];
            if (k == last) {
                passed_on[k] = rooms.take(n_triangles() * square(s.n_below(k)));
                rest = passed_on[k].room.get();
            }
            if (!eliminate(k, rest, left, first == last ? together : alone, least_pivots)) {
                regular = false;
                return tree.stop();
            }
        }
        for (int child = f.plan_.first_child[last]; child >= 0 && first == last; child = f.plan_.next_child[child])
            rooms.give_back(std::exchange(passed_on[child], {}));
    }
};

void MultifrontalFactor::analyze(const BlockPattern& pattern, const std::vector<int>& position) {
    forget();
    position_ = position;
    block_at_.resize(position.size());
    for (std::size_t b = 0; b < position.size(); ++b) block_at_[position[b]] = static_cast<int>(b);
    supernodes_ = block_supernodes(pattern, position);
    plan_ = plan_for(supernodes_);
}

MultifrontalFactor::Plan MultifrontalFactor::plan_for(const BlockSupernodes& s) {
    const int n = s.size();
    Plan plan;
    plan.first_child.assign(n, -1);
    plan.next_child.assign(n, -1);
    for (int k = n - 1; k >= 0; --k) {
        if (s.parent[k] < 0) continue;
        plan.next_child[k] = plan.first_child[s.parent[k]];
        plan.first_child[s.parent[k]] = k;
    }
    std::vector<double> work(n, 0.0); // of each branch
    std::vector<int> first(n);        // supernode of each branch
    plan.stack.assign(n, 0);
    plan.least_ratio.assign(n, 0.0);
    for (int k = 0; k < n; ++k) {
        const double n_rows = s.n_columns(k) + s.n_below(k);
        work[k] += s.n_columns(k) * n_rows * n_rows;
        first[k] = plan.first_child[k] >= 0 ? first[plan.first_child[k]] : k;
        if (s.parent[k] >= 0) work[s.parent[k]] += work[k];
        const double n_eliminated = s.nu * static_cast<double>(s.first_block[k + 1] - s.first_block[first[k]]);
        plan.least_ratio[k] = std::max(least_pivot_share, pivot_noise * std::sqrt(n_eliminated));
    }
    double all = 0.0;
    for (int k = n - 1; k >= 0; --k) {
        if (s.parent[k] < 0) {
            all += work[k];
        } else {
            plan.stack[k] = static_cast<char>(1 - plan.stack[s.parent[k]]);
        }
    }

    std::vector<int> task_of(n, -1); // that ends with this supernode
    for (int k = 0; k < n; ++k) {
        const bool is_branch = work[k] <= branch_share * all;
        if (is_branch && s.parent[k] >= 0 && work[s.parent[k]] <= branch_share * all) continue;
        task_of[k] = static_cast<int>(plan.tasks.size());
        plan.tasks.push_back({is_branch ? first[k] : k, k});
    }
    for (const Task& task : plan.tasks) {
        const int parent = s.parent[task.last];
        plan.task_parent.push_back(parent >= 0 ? task_of[parent] : -1);
    }

    plan.place.assign(n, 0);
    std::size_t passed_on = 0;
    for (const Task& task : plan.tasks) {
        std::array<std::size_t, 2> used{};
        for (int k = task.first; k < task.last; ++k) {
            std::size_t& top = used[plan.stack[k]];
            plan.place[k] = top;
            top += square(s.n_below(k));
            plan.stack_sizes[plan.stack[k]] = std::max(plan.stack_sizes[plan.stack[k]], top);
            for (int child = plan.first_child[k]; child >= 0; child = plan.next_child[child])
                used[plan.stack[child]] -= square(s.n_below(child));
        }
        passed_on += square(s.n_below(task.last));
        plan.passed_on = std::max(plan.passed_on, passed_on);
        if (task.first < task.last) continue;
        for (int child = plan.first_child[task.last]; child >= 0; child = plan.next_child[child])
            passed_on -= square(s.n_below(child));
    }
    return plan;
}

bool MultifrontalFactor::factorize(const BlockMatrix& matrix, Symmetry symmetry) {
    try {
        const auto n = static_cast<std::size_t>(supernodes_.value_starts.back());
        const auto make_room = [&](auto& values) {
            if (!values) values = room_for(n + rounded_padding);
            std::fill_n(values.get() + n, rounded_padding, 0.0F);
        };
        const bool is_symmetric = symmetry == Symmetry::symmetric;
        make_room(values_);
        if (is_symmetric) {
            upper_values_.reset();
        } else {
            make_room(upper_values_);
        }
        const bool is_small = supernodes_.nu * position_.size() < unknowns_worth_threads;
        const OwnThreads threads(is_small ? 1 : blas_threads());
        Numbers numbers(*this, matrix, values_.get(), upper_values_.get());
        std::vector<Stacks> stacks(threads.number());
        for (Stacks& each : stacks) {
            for (int i = 0; i < 2; ++i) each[i] = room_for(numbers.n_triangles() * plan_.stack_sizes[i]);
        }
        std::vector<std::vector<float>> least_pivots(threads.number());
        numbers.tree.run(threads.number(),
                         [&](int task, int thread) { numbers.do_task(task, stacks[thread], least_pivots[thread]); });
        if (!numbers.regular) forget();
        return numbers.regular;
    } catch (const std::bad_alloc&) {
        forget();
        throw ResourceError("out of memory in the factorization");
    }
}

double MultifrontalFactor::bytes() const {
    return static_cast<double>(sizeof(float)) * static_cast<double>(supernodes_.value_starts.back());
}

double MultifrontalFactor::front_bytes() const {
    return static_cast<double>(sizeof(float)) *
           static_cast<double>(plan_.stack_sizes[0] + plan_.stack_sizes[1] + plan_.passed_on);
}

} // namespace kluft
