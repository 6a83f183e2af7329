#include "kluft/blocks/whole_cells.hpp"

#include <bit>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>

#include "kluft/core/mixed_bits.hpp"

namespace kluft {

namespace {

struct HashOfPlace {
    std::size_t operator()(const Vec2& p) const {
        const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); }; // of -0 those of 0
        return mixed_bits(mixed_bits(bits(p.x())) ^ bits(p.y()));
    }
};

/// Puts whole cells into a map; the vertices and edges that they share with it are found by their places.
class CellInserter {
public:
    CellInserter(PlanarMap& map, const WholeCells& whole, int source)
        : map_(map), whole_(whole), source_(source), n_vertices_before_(static_cast<int>(map.positions.size())) {}

    void insert() {
        find_shared_vertices();
        find_sides();
        for (std::size_t c = 0; c < whole_.cells.size(); ++c) add_face(sides_[c]);
        for (const int face : filled_) map_.faces[face] = {};
    }

private:
    void find_shared_vertices() {
        std::vector<char> shared(whole_.vertices.size(), 0);
        for (const WholeCell& cell : whole_.cells) {
            for (int k = 0; k < 6; ++k) {
                if (cell.across[k] >= 0) continue;
                shared[cell.vertices[k]] = 1;
                shared[cell.vertices[(k + 1) % 6]] = 1;
            }
        }
        std::unordered_map<Vec2, int, HashOfPlace> at;
        for (int v = 0; v < n_vertices_before_; ++v) at.emplace(map_.positions[v], v);
        vertices_.reserve(whole_.vertices.size());
        map_.positions.reserve(map_.positions.size() + whole_.vertices.size());
        map_.outgoing.reserve(map_.positions.capacity());
        for (std::size_t v = 0; v < whole_.vertices.size(); ++v) {
            vertices_.push_back(shared[v] != 0 ? found(at, whole_.vertices[v]) : add_vertex(whole_.vertices[v]));
        }
    }

    static int found(const std::unordered_map<Vec2, int, HashOfPlace>& at, const Vec2& place) {
        const auto vertex = at.find(place);
        if (vertex == at.end()) throw std::logic_error("a whole cell lacks a vertex of its neighbour's");
        return vertex->second;
    }

    int add_vertex(const Vec2& place) {
        map_.positions.push_back(place);
        map_.outgoing.push_back(-1);
        return static_cast<int>(map_.positions.size()) - 1;
    }

    /// The half-edges of each cell; an edge between two of them is added with the first.
    void find_sides() {
        sides_.resize(whole_.cells.size());
        for (int c = 0; c < static_cast<int>(whole_.cells.size()); ++c) {
            const WholeCell& cell = whole_.cells[c];
            for (int k = 0; k < 6; ++k) {
                const int from = vertices_[cell.vertices[k]];
                const int to = vertices_[cell.vertices[(k + 1) % 6]];
                const int across = cell.across[k];
                if (across < 0) {
                    sides_[c][k] = side_of_map(from, to);
                } else if (across > c) {
                    sides_[c][k] = add_edge(from, to);
                } else {
                    sides_[c][k] = PlanarMap::twin(sides_[across][(k + 3) % 6]); // the opposite side
                }
            }
        }
    }

    [[nodiscard]] int side_of_map(int from, int to) const {
        const int first = map_.outgoing[from];
        int h = first;
        do {
            if (map_.end(h) == to) return h;
            h = PlanarMap::twin(map_.previous(h));
        } while (h != first);
        throw std::logic_error("a whole cell lacks a side of its neighbour's");
    }

    int add_edge(int from, int to) {
        const int h = 2 * map_.n_edges();
        map_.half_edges.push_back({.start = from});
        map_.half_edges.push_back({.start = to});
        map_.sources.push_back(source_);
        map_.alive.push_back(1);
        if (map_.outgoing[from] < 0) map_.outgoing[from] = h;
        if (map_.outgoing[to] < 0) map_.outgoing[to] = h + 1;
        return h;
    }

    void add_face(const std::array<int, 6>& sides) {
        const int face = map_.n_faces();
        for (int k = 0; k < 6; ++k) {
            PlanarMap::HalfEdge& side = map_.half_edges[sides[k]];
            if (side.face != PlanarMap::outside && (filled_.empty() || filled_.back() != side.face))
                filled_.push_back(side.face);
            side.next = sides[(k + 1) % 6];
            side.previous = sides[(k + 5) % 6];
            side.face = face;
        }
        map_.faces.emplace_back(sides.begin(), sides.end());
    }

    PlanarMap& map_;
    const WholeCells& whole_;
    int source_;
    int n_vertices_before_;
    std::vector<int> vertices_;             ///< of the map, for each of the cells'
    std::vector<std::array<int, 6>> sides_; ///< half-edges of each cell
    std::vector<int> filled_;               ///< faces of the map, some of them more than once
};

} // namespace

void insert_whole_cells(PlanarMap& map, const WholeCells& whole, int source) {
    if (whole.cells.empty()) return;
    CellInserter(map, whole, source).insert();
}

} // namespace kluft
