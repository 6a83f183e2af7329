#include "kluft/constitutive/net_kind.hpp"

namespace kluft {

NetKind net_kind(const Tessellation& tessellation) {
    if (tessellation.triangles) return NetKind::triangles;
    return tessellation.voronoi ? NetKind::voronoi : NetKind::hexagons;
}

const char* cells_of(NetKind kind) {
    switch (kind) {
    case NetKind::hexagons:
        return "hexagons";
    case NetKind::voronoi:
        return "Voronoi cells";
    case NetKind::triangles:
        return "triangles";
    }
    return "";
}

RatioRange good_stiffness_ratio(NetKind kind) {
    switch (kind) {
    case NetKind::hexagons:
    case NetKind::voronoi:
        return {.least = 5.0, .most = 20.0};
    case NetKind::triangles:
        return {.least = 10.0, .most = 60.0};
    }
    return {};
}

double default_stiffness_ratio(NetKind kind) { return kind == NetKind::triangles ? 30.0 : 10.0; }

bool interlocks(NetKind kind) {
    switch (kind) {
    case NetKind::hexagons:
    case NetKind::voronoi:
        return true;
    case NetKind::triangles:
        return false;
    }
    return false;
}

} // namespace kluft
