#include "kluft/constitutive/net_kind.hpp"

namespace kluft {

NetKind net_kind(const Tessellation& tessellation) {
    return tessellation.voronoi ? NetKind::voronoi : NetKind::hexagons;
}

const char* cells_of(NetKind kind) {
    switch (kind) {
    case NetKind::hexagons:
        return "hexagons";
    case NetKind::voronoi:
        return "Voronoi cells";
    }
    return "";
}

RatioRange good_stiffness_ratio(NetKind kind) {
    switch (kind) {
    case NetKind::hexagons:
    case NetKind::voronoi:
        return {.least = 5.0, .most = 20.0};
    }
    return {};
}

bool interlocks(NetKind kind) {
    switch (kind) {
    case NetKind::hexagons:
    case NetKind::voronoi:
        return true;
    }
    return false;
}

} // namespace kluft
