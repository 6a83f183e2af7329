#include "kluft/blocks/hexagon_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/mixed_bits.hpp"

namespace kluft {

namespace {

using std::numbers::sqrt3;

/// Indices of a lattice vertex: multiples of d/2 along x and of d/(2 sqrt 3) along y.
struct LatticePoint {
    std::int64_t p = 0;
    std::int64_t q = 0;
};

/// The six vertices of the hexagon about (0, 0), counter-clockwise from the lower end of its right flat, and the
/// steps (in cells i, j) to the neighbours across the edges that start at them.
constexpr std::array<LatticePoint, 6> corners{{{1, -1}, {1, 1}, {0, 2}, {-1, 1}, {-1, -1}, {0, -2}}};
constexpr std::array<std::array<int, 2>, 6> neighbours{{{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}};

/// In [-1, 1), from the upper 53 bits.
double symmetric_unit(std::uint64_t bits) { return static_cast<double>(bits >> 11U) * 0x1.0p-52 - 1.0; }

/// A point of the unit disc that depends on the seed and the indices only; by rejection from the square.
Vec2 disc_point(std::uint64_t seed, LatticePoint at) {
    std::uint64_t state = mixed_bits(mixed_bits(seed) ^ static_cast<std::uint32_t>(at.p));
    state = mixed_bits(state ^ static_cast<std::uint32_t>(at.q));
    while (true) {
        const double x = symmetric_unit(state = mixed_bits(state));
        const double y = symmetric_unit(state = mixed_bits(state));
        if (x * x + y * y <= 1.0) return {x, y};
    }
}

class LatticeFrame {
public:
    explicit LatticeFrame(const HexagonLattice& lattice)
        : lattice_(lattice), cosine_(std::cos(lattice.rotation)), sine_(std::sin(lattice.rotation)) {}

    [[nodiscard]] Vec2 position(LatticePoint at) const {
        const double x = static_cast<double>(at.p) * (0.5 * lattice_.spacing);
        const double y = static_cast<double>(at.q) * (lattice_.spacing / (2.0 * sqrt3));
        return lattice_.offset + Vec2(cosine_ * x - sine_ * y, sine_ * x + cosine_ * y);
    }

    [[nodiscard]] Vec2 vertex(LatticePoint at) const {
        if (lattice_.jitter == 0.0) return position(at);
        return position(at) + lattice_.jitter * lattice_.spacing * disc_point(lattice_.seed, at);
    }

    /// Lattice coordinates without rotation and offset (m).
    [[nodiscard]] Vec2 unrotated(const Vec2& point) const {
        const Vec2 from = point - lattice_.offset;
        return {cosine_ * from.x() + sine_ * from.y(), -sine_ * from.x() + cosine_ * from.y()};
    }

private:
    HexagonLattice lattice_;
    double cosine_;
    double sine_;
};

LatticePoint centre(std::int64_t i, std::int64_t j) { return {2 * i + j, 3 * j}; }

LatticePoint corner(std::int64_t i, std::int64_t j, int k) {
    const LatticePoint c = centre(i, j);
    return {c.p + corners[k].p, c.q + corners[k].q};
}

bool boxes_meet(const Box& box, const Vec2& a, const Vec2& b) {
    return std::max(a.x(), b.x()) >= box.lower.x() && std::min(a.x(), b.x()) <= box.upper.x() &&
           std::max(a.y(), b.y()) >= box.lower.y() && std::min(a.y(), b.y()) <= box.upper.y();
}

void check(const HexagonLattice& lattice) {
    if (!(lattice.spacing > 0.0) || !std::isfinite(lattice.spacing)) {
        throw InputError(fmt::format("geometry.tessellation.hexagons.spacing: expected a length above 0, found {}",
                                     lattice.spacing));
    }
    if (!(lattice.jitter >= 0.0 && lattice.jitter < 0.25)) {
        throw InputError(fmt::format("geometry.tessellation.hexagons.jitter: expected 0 <= jitter < 0.25, found {}",
                                     lattice.jitter));
    }
    if (!std::isfinite(lattice.rotation) || !lattice.offset.allFinite()) {
        throw InputError("geometry.tessellation.hexagons: rotation and offset must be finite numbers");
    }
    constexpr double farthest = 1e9;
    if (lattice.offset.cwiseAbs().maxCoeff() > farthest * lattice.spacing) {
        throw InputError(
            fmt::format("geometry.tessellation.hexagons.offset: expected at most {:.0g} spacings, found ({}, "
                        "{}) m",
                        farthest, lattice.offset.x(), lattice.offset.y()));
    }
}

/// The hexagons that can meet a box, by rows, and what becomes of each.
class LatticeCells {
public:
    LatticeCells(const HexagonLattice& lattice, const Box& box) : lattice_(lattice), frame_(lattice), box_(box) {
        const double d = lattice.spacing;
        const double reach = hexagon_reach(lattice);
        const Box covered = bounding_box({frame_.unrotated(box.lower), frame_.unrotated(box.upper),
                                          frame_.unrotated({box.lower.x(), box.upper.y()}),
                                          frame_.unrotated({box.upper.x(), box.lower.y()})});
        const double row = 0.5 * sqrt3 * d;
        const double n_cells = ((covered.upper.y() - covered.lower.y() + 2.0 * reach) / row + 3.0) *
                               ((covered.upper.x() - covered.lower.x() + 2.0 * reach) / d + 3.0);
        constexpr double most_in_box = 5.0 * most_cells; // of which the body may fill a part
        if (n_cells > most_in_box) {
            throw InputError(
                fmt::format("geometry.tessellation.hexagons.spacing: {} m makes {:.2g} hexagons, more than "
                            "{:.0g} in one scene",
                            d, n_cells, most_in_box));
        }
        const auto below = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
        const auto above = [](double x) { return static_cast<std::int64_t>(std::ceil(x)); };
        first_row_ = below((covered.lower.y() - reach) / row);
        const std::int64_t last_row = above((covered.upper.y() + reach) / row);
        for (std::int64_t j = first_row_; j <= last_row; ++j) {
            const double shift = 0.5 * static_cast<double>(j);
            const std::int64_t first = below((covered.lower.x() - reach) / d - shift);
            const std::int64_t last = above((covered.upper.x() + reach) / d - shift);
            rows_.push_back({first, std::vector<Cell>(static_cast<std::size_t>(last - first + 1))});
        }
    }

    void classify(const std::function<bool(const Vec2&)>& keeps, const std::function<bool(const Vec2&)>& is_clear) {
        const double reach = hexagon_reach(lattice_);
        for_each([&](std::int64_t i, std::int64_t j, Cell& cell) {
            const Vec2 c = frame_.position(centre(i, j));
            cell.kept = c.x() >= box_.lower.x() - reach && c.x() <= box_.upper.x() + reach &&
                        c.y() >= box_.lower.y() - reach && c.y() <= box_.upper.y() + reach && keeps(c);
        });
        int n_whole = 0;
        for_each([&](std::int64_t i, std::int64_t j, Cell& cell) {
            const bool inside = cell.kept && std::ranges::all_of(neighbours, [&](const auto& step) {
                                    return is_kept(i + step[0], j + step[1]);
                                });
            if (inside && is_clear(frame_.position(centre(i, j)))) cell.whole = n_whole++;
        });
    }

    /// Edges that are sides of a hexagon that is not whole.
    [[nodiscard]] std::vector<std::pair<Vec2, Vec2>> edges() {
        std::vector<std::pair<Vec2, Vec2>> edges;
        for_each([&](std::int64_t i, std::int64_t j, const Cell& cell) {
            if (!cell.kept) return;
            for (int k = 0; k < 6; ++k) {
                const std::int64_t i_across = i + neighbours[k][0];
                const std::int64_t j_across = j + neighbours[k][1];
                // The first three edges are this cell's own; the others only where the cell across is not kept.
                if (k >= 3 && is_kept(i_across, j_across)) continue;
                if (cell.whole >= 0 && whole_at(i_across, j_across) >= 0) continue;
                const Vec2 a = frame_.vertex(corner(i, j, k));
                const Vec2 b = frame_.vertex(corner(i, j, (k + 1) % 6));
                if (boxes_meet(box_, a, b)) edges.emplace_back(a, b);
            }
        });
        return edges;
    }

    [[nodiscard]] WholeCells whole_cells() {
        WholeCells whole;
        for_each([&](std::int64_t i, std::int64_t j, const Cell& cell) {
            if (cell.whole < 0) return;
            WholeCell& added = whole.cells.emplace_back();
            for (int k = 0; k < 6; ++k) {
                added.vertices[k] = number_of_corner(i, j, k, whole.vertices);
                added.across[k] = whole_at(i + neighbours[k][0], j + neighbours[k][1]);
            }
        });
        return whole;
    }

private:
    struct Cell {
        bool kept = false;
        int whole = -1; ///< number among the whole cells
        int top = -1;   ///< numbers of its vertices at (0, 2) and (0, -2) among those of the whole cells
        int bottom = -1;
    };
    struct Row {
        std::int64_t first = 0;
        std::vector<Cell> cells;
    };

    template <class Visit> void for_each(const Visit& visit) {
        std::int64_t j = first_row_;
        for (Row& row : rows_) {
            std::int64_t i = row.first;
            for (Cell& cell : row.cells) visit(i++, j, cell);
            ++j;
        }
    }

    [[nodiscard]] const Cell* find(std::int64_t i, std::int64_t j) const {
        const std::int64_t r = j - first_row_;
        if (r < 0 || r >= std::ssize(rows_)) return nullptr;
        const std::int64_t c = i - rows_[r].first;
        return c < 0 || c >= std::ssize(rows_[r].cells) ? nullptr : &rows_[r].cells[c];
    }

    [[nodiscard]] bool is_kept(std::int64_t i, std::int64_t j) const {
        const Cell* cell = find(i, j);
        return cell != nullptr && cell->kept;
    }

    [[nodiscard]] int whole_at(std::int64_t i, std::int64_t j) const {
        const Cell* cell = find(i, j);
        return cell == nullptr ? -1 : cell->whole;
    }

    /// Each vertex is the top or the bottom of exactly one hexagon. Of a whole one, all six of these are kept ones.
    int number_of_corner(std::int64_t i, std::int64_t j, int k, std::vector<Vec2>& vertices) {
        constexpr std::array<std::array<int, 2>, 6> steps{{{1, -1}, {0, 1}, {0, 0}, {-1, 1}, {0, -1}, {0, 0}}};
        const std::int64_t r = j + steps[k][1] - first_row_;
        Cell& holder = rows_[r].cells[i + steps[k][0] - rows_[r].first];
        int& number = k % 2 == 0 ? holder.top : holder.bottom;
        if (number < 0) {
            number = static_cast<int>(vertices.size());
            vertices.push_back(frame_.vertex(corner(i, j, k)));
        }
        return number;
    }

    HexagonLattice lattice_;
    LatticeFrame frame_;
    Box box_;
    std::int64_t first_row_ = 0;
    std::vector<Row> rows_;
};

} // namespace

double hexagon_reach(const HexagonLattice& lattice) { return lattice.spacing * (1.0 / sqrt3 + lattice.jitter); }

double hexagon_area(double spacing) { return 0.5 * sqrt3 * spacing * spacing; }

HexagonNet hexagon_net(const HexagonLattice& lattice, const Box& box, const std::function<bool(const Vec2&)>& keeps,
                       const std::function<bool(const Vec2&)>& is_clear) {
    check(lattice);
    LatticeCells cells(lattice, box);
    cells.classify(keeps, is_clear);
    return {.whole = cells.whole_cells(), .edges = cells.edges()};
}

std::vector<std::pair<Vec2, Vec2>> hexagon_edges(const HexagonLattice& lattice, const Box& box,
                                                 const std::function<bool(const Vec2&)>& keeps) {
    return hexagon_net(lattice, box, keeps, [](const Vec2& /*centre*/) { return false; }).edges;
}

} // namespace kluft
