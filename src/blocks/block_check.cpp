#include "kluft/blocks/block_check.hpp"

#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft {

namespace {

class PartitionCheck {
public:
    PartitionCheck(const BlockSystem& system, const PartitionExpectation& expected)
        : system_(system), expected_(expected) {}

    std::vector<std::string> run() {
        check_indices();
        if (!sentences_.empty()) return std::move(sentences_);
        for (int b = 0; b < system_.n_blocks(); ++b) {
            check_loops(b);
            check_moments(b);
        }
        check_interfaces();
        check_directed_edges();
        check_boundaries();
        check_vertices_are_used();
        check_total_area();
        return std::move(sentences_);
    }

private:
    template <typename... Args> void say(fmt::format_string<Args...> text, Args&&... args) {
        constexpr std::size_t most = 50;
        if (sentences_.size() < most) sentences_.push_back(fmt::format(text, std::forward<Args>(args)...));
    }

    [[nodiscard]] bool is_edge(int block, int edge) const {
        return block >= 0 && block < system_.n_blocks() && edge >= 0 &&
               edge < static_cast<int>(system_.blocks[block].edges.size());
    }

    void check_indices() {
        const int n_vertices = static_cast<int>(system_.vertices.size());
        const int n_boundaries = static_cast<int>(system_.boundaries.size());
        for (int b = 0; b < system_.n_blocks(); ++b) {
            const Block& block = system_.blocks[b];
            if (block.loop_starts.empty() || block.loop_starts.front() != 0) say("block {} has no outline", b);
            for (std::size_t l = 0; l < block.loop_starts.size(); ++l) {
                if (loop_end(block, l) - block.loop_starts[l] < 3) say("loop {} of block {} has no three edges", l, b);
            }
            for (const Edge& edge : block.edges) {
                if (edge.start < 0 || edge.start >= n_vertices || edge.end < 0 || edge.end >= n_vertices) {
                    say("an edge of block {} names a vertex that does not exist", b);
                }
                if (edge.interface < -1 || edge.interface >= system_.n_interfaces()) {
                    say("an edge of block {} names an interface that does not exist", b);
                }
                if (edge.boundary < -1 || edge.boundary >= n_boundaries) {
                    say("an edge of block {} names a boundary that does not exist", b);
                }
            }
        }
        for (int i = 0; i < system_.n_interfaces(); ++i) {
            const Interface& joint = system_.interfaces[i];
            if (!is_edge(joint.block_a, joint.edge_a) || !is_edge(joint.block_b, joint.edge_b)) {
                say("interface {} names an edge that does not exist", i);
            }
        }
    }

    [[nodiscard]] static int loop_end(const Block& block, std::size_t loop) {
        return loop + 1 < block.loop_starts.size() ? block.loop_starts[loop + 1] : static_cast<int>(block.edges.size());
    }

    void check_loops(int b) {
        const Block& block = system_.blocks[b];
        std::vector<Polygon> loops;
        for (std::size_t l = 0; l < block.loop_starts.size(); ++l) {
            const int first = block.loop_starts[l];
            const int last = loop_end(block, l);
            Polygon polygon;
            for (int i = first; i < last; ++i) {
                const Edge& edge = block.edges[i];
                if (edge.end != block.edges[i + 1 < last ? i + 1 : first].start) {
                    say("loop {} of block {} does not close after edge {}", l, b, i);
                }
                polygon.push_back(edge_start(system_, edge));
            }
            if (!is_simple(polygon)) say("loop {} of block {} is not simple", l, b);
            const bool counter_clockwise = signed_area(polygon) > 0.0;
            if (counter_clockwise != (l == 0)) say("loop {} of block {} runs the wrong way round", l, b);
            loops.push_back(std::move(polygon));
        }
        for (std::size_t l = 1; l < loops.size(); ++l) check_hole(b, loops, l);
    }

    /// The vertices of a hole lie in the outline and in no other hole (common vertices are allowed).
    void check_hole(int b, const std::vector<Polygon>& loops, std::size_t hole) {
        for (const Vec2& p : loops[hole]) {
            if (!contains(loops[0], p)) say("hole {} of block {} leaves its outline", hole, b);
            for (std::size_t other = 1; other < loops.size(); ++other) {
                if (other == hole || !contains(loops[other], p)) continue;
                bool shared = false;
                for (const Vec2& q : loops[other]) shared = shared || p == q;
                if (!shared) say("holes {} and {} of block {} overlap", hole, other, b);
            }
        }
    }

    void check_moments(int b) {
        const Block& block = system_.blocks[b];
        Block measured = block;
        compute_block_moments(system_.vertices, measured);
        const double h = measured.size;
        if (!(block.area > 0.0)) say("block {} has the area {}", b, block.area);
        if (!(block.area >= expected_.minimum_area)) {
            say("block {} of area {} is below the minimum {}", b, block.area, expected_.minimum_area);
        }
        if (!(std::abs(block.area - measured.area) <= 1e-12 * h * h) || !(std::abs(block.size - h) <= 1e-12 * h) ||
            !((block.centroid - measured.centroid).norm() <= 1e-9 * h) ||
            !((block.second_moment - measured.second_moment).norm() <= 1e-9 * measured.second_moment.norm())) {
            say("the moments of block {} are not those of its edges", b);
        }
    }

    void check_interfaces() {
        std::vector<int> n_sides(system_.n_interfaces(), 0);
        for (const Block& block : system_.blocks) {
            for (const Edge& edge : block.edges) {
                if (edge.interface >= 0) ++n_sides[edge.interface];
            }
        }
        for (int i = 0; i < system_.n_interfaces(); ++i) {
            const Interface& joint = system_.interfaces[i];
            const Edge& a = system_.blocks[joint.block_a].edges[joint.edge_a];
            const Edge& b = system_.blocks[joint.block_b].edges[joint.edge_b];
            if (joint.block_a == joint.block_b) say("interface {} has block {} on both sides", i, joint.block_a);
            if (a.interface != i || b.interface != i) say("the edges of interface {} do not name it", i);
            if (n_sides[i] != 2) say("{} edges name interface {}", n_sides[i], i);
            if (a.start != b.end || a.end != b.start) say("the edges of interface {} do not match", i);
            if (a.boundary >= 0 || b.boundary >= 0) say("interface {} lies on a boundary", i);
            if (joint.origin == EdgeOrigin::boundary) say("interface {} is said to be on the outline", i);
            if ((joint.origin == EdgeOrigin::fracture) != (joint.fracture >= 0)) {
                say("interface {} is on a fracture without one, or has one without being on it", i);
            }
        }
    }

    /// Each directed edge belongs to one block, and an edge without interface has nothing on its other side.
    void check_directed_edges() {
        std::set<std::pair<int, int>> directed;
        for (int b = 0; b < system_.n_blocks(); ++b) {
            for (const Edge& edge : system_.blocks[b].edges) {
                if (!directed.emplace(edge.start, edge.end).second) {
                    say("the edge from vertex {} to {} belongs to two blocks", edge.start, edge.end);
                }
            }
        }
        for (int b = 0; b < system_.n_blocks(); ++b) {
            for (const Edge& edge : system_.blocks[b].edges) {
                if (edge.interface < 0 && directed.contains({edge.end, edge.start})) {
                    say("the edge from vertex {} to {} of block {} has a neighbour and no interface", edge.start,
                        edge.end, b);
                }
            }
        }
    }

    void check_boundaries() {
        std::size_t n_named = 0;
        for (const Block& block : system_.blocks) {
            for (const Edge& edge : block.edges) n_named += edge.boundary >= 0 ? 1 : 0;
        }
        std::size_t n_listed = 0;
        for (int k = 0; k < static_cast<int>(system_.boundaries.size()); ++k) {
            for (const BoundaryEdge& at : system_.boundaries[k].edges) {
                ++n_listed;
                if (!is_edge(at.block, at.edge) || system_.blocks[at.block].edges[at.edge].boundary != k) {
                    say("boundary {} lists an edge that does not name it", system_.boundaries[k].name);
                }
            }
        }
        if (n_named != n_listed) say("{} edges name a boundary, but the boundaries list {}", n_named, n_listed);
    }

    void check_vertices_are_used() {
        std::vector<char> used(system_.vertices.size(), 0);
        for (const Block& block : system_.blocks) {
            for (const Edge& edge : block.edges) used[edge.start] = 1;
        }
        for (std::size_t v = 0; v < used.size(); ++v) {
            if (used[v] == 0) say("no block uses vertex {}", v);
        }
    }

    void check_total_area() {
        if (std::isnan(expected_.domain_area)) return;
        // Compensated (Neumaier 1974): 200 000 equal areas added one by one lose more than 1e-12.
        double sum = 0.0;
        double lost = 0.0;
        for (const Block& block : system_.blocks) {
            const double next = sum + block.area;
            lost += sum >= block.area ? (sum - next) + block.area : (block.area - next) + sum;
            sum = next;
        }
        const double total = sum + lost;
        if (!(std::abs(total - expected_.domain_area) <= 1e-12 * expected_.domain_area)) {
            say("the blocks' areas sum to {} instead of {}", total, expected_.domain_area);
        }
    }

    const BlockSystem& system_;
    PartitionExpectation expected_;
    std::vector<std::string> sentences_;
};

} // namespace

std::vector<std::string> check_block_system(const BlockSystem& system, const PartitionExpectation& expected) {
    return PartitionCheck(system, expected).run();
}

} // namespace kluft
