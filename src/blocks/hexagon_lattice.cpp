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
        throw InputError(
            fmt::format("geometry.tessellation.hexagons.spacing: expected a length above 0, got {}", lattice.spacing));
    }
    if (!(lattice.jitter >= 0.0 && lattice.jitter < 0.25)) {
        throw InputError(
            fmt::format("geometry.tessellation.hexagons.jitter: expected 0 <= jitter < 0.25, got {}", lattice.jitter));
    }
    if (!std::isfinite(lattice.rotation) || !lattice.offset.allFinite()) {
        throw InputError("geometry.tessellation.hexagons: rotation and offset must be finite numbers");
    }
    constexpr double farthest = 1e9;
    if (lattice.offset.cwiseAbs().maxCoeff() > farthest * lattice.spacing) {
        throw InputError(
            fmt::format("geometry.tessellation.hexagons.offset: expected at most {:.0g} spacings, got ({}, "
                        "{}) m",
                        farthest, lattice.offset.x(), lattice.offset.y()));
    }
}

} // namespace

double hexagon_reach(const HexagonLattice& lattice) { return lattice.spacing * (1.0 / sqrt3 + lattice.jitter); }

double hexagon_area(double spacing) { return 0.5 * sqrt3 * spacing * spacing; }

std::vector<std::pair<Vec2, Vec2>> hexagon_edges(const HexagonLattice& lattice, const Box& box,
                                                 const std::function<bool(const Vec2&)>& keeps) {
    check(lattice);
    const LatticeFrame frame(lattice);
    const double d = lattice.spacing;
    const double reach = hexagon_reach(lattice);
    const Box covered = bounding_box({frame.unrotated(box.lower), frame.unrotated(box.upper),
                                      frame.unrotated({box.lower.x(), box.upper.y()}),
                                      frame.unrotated({box.upper.x(), box.lower.y()})});
    const double row = 0.5 * sqrt3 * d;
    const double n_cells = ((covered.upper.y() - covered.lower.y() + 2.0 * reach) / row + 3.0) *
                           ((covered.upper.x() - covered.lower.x() + 2.0 * reach) / d + 3.0);
    constexpr double most_in_box = 5.0 * most_cells; // of which the body may fill a part
    if (n_cells > most_in_box) {
        throw InputError(fmt::format("geometry.tessellation.hexagons.spacing: {} m makes {:.2g} hexagons, more than "
                                     "{:.0g} in one scene",
                                     d, n_cells, most_in_box));
    }
    const auto below = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
    const auto above = [](double x) { return static_cast<std::int64_t>(std::ceil(x)); };
    const std::int64_t first_row = below((covered.lower.y() - reach) / row);
    const std::int64_t last_row = above((covered.upper.y() + reach) / row);

    const auto kept = [&](std::int64_t i, std::int64_t j) {
        const Vec2 c = frame.position(centre(i, j));
        return c.x() >= box.lower.x() - reach && c.x() <= box.upper.x() + reach && c.y() >= box.lower.y() - reach &&
               c.y() <= box.upper.y() + reach && keeps(c);
    };
    std::vector<std::pair<Vec2, Vec2>> edges;
    for (std::int64_t j = first_row; j <= last_row; ++j) {
        const double shift = 0.5 * static_cast<double>(j);
        const std::int64_t first = below((covered.lower.x() - reach) / d - shift);
        const std::int64_t last = above((covered.upper.x() + reach) / d - shift);
        for (std::int64_t i = first; i <= last; ++i) {
            if (!kept(i, j)) continue;
            for (int k = 0; k < 6; ++k) {
                // The first three edges are this cell's own; the others only where the cell across is not kept.
                if (k >= 3 && kept(i + neighbours[k][0], j + neighbours[k][1])) continue;
                const Vec2 a = frame.vertex(corner(i, j, k));
                const Vec2 b = frame.vertex(corner(i, j, (k + 1) % 6));
                if (boxes_meet(box, a, b)) edges.emplace_back(a, b);
            }
        }
    }
    return edges;
}

} // namespace kluft
