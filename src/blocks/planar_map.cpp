#include "kluft/blocks/planar_map.hpp"

#include <algorithm>
#include <cassert>
#include <unordered_map>

namespace kluft {

std::vector<int> PlanarMap::star(int v) const {
    std::vector<int> spokes;
    const int first = outgoing[v];
    if (first < 0) return spokes;
    int h = first;
    do {
        spokes.push_back(h);
        h = next(twin(h));
    } while (h != first);
    return spokes;
}

int PlanarMap::degree(int v, int limit) const {
    const int first = outgoing[v];
    if (first < 0) return 0;
    int count = 0;
    int h = first;
    do {
        ++count;
        h = next(twin(h));
    } while (h != first && count < limit);
    return count;
}

int PlanarMap::cycle_length(int h, int limit) const {
    int count = 1;
    for (int k = next(h); k != h && count < limit; k = next(k)) ++count;
    return count;
}

const std::vector<int>& PlanarMap::half_edges_of(int f) {
    std::erase_if(faces[f], [this](int h) { return alive[edge_of(h)] == 0; });
    return faces[f];
}

std::vector<std::vector<int>> PlanarMap::loops(int f) {
    std::vector<std::vector<int>> result;
    std::unordered_map<int, char> seen;
    for (const int first : half_edges_of(f)) {
        if (seen.contains(first)) continue;
        std::vector<int> path;
        std::unordered_map<int, std::size_t> place; // of each start vertex on the path
        int h = first;
        do {
            seen.emplace(h, 1);
            const auto at = place.find(start(h));
            if (at != place.end()) {
                const std::size_t from = at->second;
                std::vector<int> closed(path.begin() + static_cast<std::ptrdiff_t>(from), path.end());
                for (const int k : closed) place.erase(start(k));
                path.resize(from);
                result.push_back(std::move(closed));
            }
            place.emplace(start(h), path.size());
            path.push_back(h);
            h = next(h);
        } while (h != first);
        result.push_back(std::move(path));
    }
    return result;
}

double PlanarMap::loop_area(const std::vector<int>& loop) const {
    const Vec2& from = positions[start(loop.front())];
    double twice = 0.0;
    for (const int h : loop) twice += cross(positions[start(h)] - from, positions[end(h)] - from);
    return 0.5 * twice;
}

double PlanarMap::area(int f) {
    const std::vector<int>& list = half_edges_of(f);
    if (list.empty()) return 0.0;
    return loop_area(list); // the sum over closed loops does not depend on the order of the edges
}

void PlanarMap::link(int h, int following) {
    half_edges[h].next = following;
    half_edges[following].previous = h;
}

void PlanarMap::remove_edge(int e) {
    for (const int h : {2 * e, 2 * e + 1}) {
        const int v = start(h);
        const int arriving = previous(h);
        const int leaving = next(twin(h));
        if (leaving == h) {
            outgoing[v] = -1;
            continue;
        }
        link(arriving, leaving);
        if (outgoing[v] == h) outgoing[v] = leaving;
    }
    alive[e] = 0;
}

void PlanarMap::remove_edges_inside_faces() {
    for (int e = 0; e < n_edges(); ++e) {
        if (alive[e] != 0 && face(2 * e) == face(2 * e + 1)) remove_edge(e);
    }
}

void PlanarMap::merge_faces(int kept, int lost) {
    assert(kept != lost && kept != outside && lost != outside);
    std::vector<int> shared;
    for (const int h : half_edges_of(lost)) {
        if (face(twin(h)) == kept) shared.push_back(edge_of(h));
    }
    for (const int h : faces[lost]) half_edges[h].face = kept;
    faces[kept].insert(faces[kept].end(), faces[lost].begin(), faces[lost].end());
    faces[lost] = {};
    for (const int e : shared) remove_edge(e);
}

void PlanarMap::take_away(int f, int source) {
    const std::vector<int> half_edges_there = half_edges_of(f);
    faces[f] = {};
    for (const int h : half_edges_there) half_edges[h].face = outside;
    for (const int h : half_edges_there) {
        if (face(twin(h)) == outside)
            remove_edge(edge_of(h));
        else
            sources[edge_of(h)] = source;
    }
}

int PlanarMap::dissolve_vertex(int v) {
    const int leaving = outgoing[v];        // v -> b
    const int arriving = previous(leaving); // a -> v
    const int back = twin(leaving);         // b -> v
    const int away = twin(arriving);        // v -> a
    assert(next(back) == away);
    const int b = start(back);
    half_edges[away].start = b;
    link(arriving, next(leaving));
    link(previous(back), away);
    if (outgoing[b] == back) outgoing[b] = away;
    outgoing[v] = -1;
    alive[edge_of(leaving)] = 0;
    return arriving;
}

int PlanarMap::split_edge(int h, const Vec2& at) {
    const int t = twin(h);
    const int b = start(t);
    const int v = static_cast<int>(positions.size());
    const int onward = 2 * n_edges(); // v -> b
    const int back = onward + 1;      // b -> v
    positions.push_back(at);
    outgoing.push_back(onward);
    sources.push_back(source(h));
    alive.push_back(1);
    half_edges.push_back({.start = v, .face = face(h)});
    half_edges.push_back({.start = b, .face = face(t)});
    if (next(h) == t) {
        link(onward, back);
    } else {
        link(onward, next(h));
        link(previous(t), back);
    }
    link(h, onward);
    link(back, t);
    half_edges[t].start = v;
    if (outgoing[b] == t) outgoing[b] = back;
    for (const int added : {onward, back})
        if (face(added) != outside) faces[face(added)].push_back(added);
    return v;
}

int PlanarMap::contract_edge(int h) {
    const int t = twin(h);
    const int kept = start(h);
    const int lost = start(t);
    for (const int spoke : star(lost)) half_edges[spoke].start = kept;
    outgoing[kept] = next(h);
    link(previous(h), next(h));
    link(previous(t), next(t));
    outgoing[lost] = -1;
    alive[edge_of(h)] = 0;
    return kept;
}

} // namespace kluft
