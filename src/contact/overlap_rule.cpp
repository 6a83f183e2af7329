#include "kluft/contact/overlap_rule.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

namespace kluft {

namespace {

constexpr double largest_end_weight = 0.005; ///< of the length of a joint
constexpr double round_off = 1e-12;          ///< of a share of a joint
constexpr int newton_iterations = 30;        ///< quadratic from Chebyshev's points: a handful would do

struct StoredRule {
    std::array<double, most_overlap_points> positions{};
    std::array<double, most_overlap_points> weights{};
};

/// The inner points are the extrema of Legendre's polynomial P of degree n - 1, the weights 1/(n (n - 1) P^2) (18). Newton's
/// method on (1 - x^2) P' = (n - 1) (P_{n-2} - x P) starts at Chebyshev's extrema.
StoredRule lobatto_rule(int n) {
    const auto degree = static_cast<unsigned>(n - 1);
    StoredRule rule;
    for (int i = 0; i <= (n - 1) / 2; ++i) {
        double x = 2 * i == n - 1 ? 0.0 : -std::cos(std::numbers::pi * i / (n - 1));
        for (int k = 0; k < newton_iterations; ++k)
            x += (std::legendre(degree - 1, x) - x * std::legendre(degree, x)) / (n * std::legendre(degree, x));
        const double p = std::legendre(degree, x);
        rule.positions[i] = 0.5 * (1.0 + x);
        rule.positions[n - 1 - i] = 0.5 * (1.0 - x);
        rule.weights[i] = rule.weights[n - 1 - i] = 1.0 / (n * (n - 1) * p * p);
    }
    return rule;
}

using StoredRules = std::array<StoredRule, most_overlap_points + 1>;

StoredRules all_rules() {
    StoredRules rules;
    for (int n = least_overlap_points; n <= most_overlap_points; ++n) rules[n] = lobatto_rule(n);
    return rules;
}

/// The end points of n have the weight 1/(n (n - 1)).
int points_for(double share_of_joint) {
    const double least = share_of_joint / largest_end_weight * (1.0 - round_off);
    int n = least_overlap_points;
    while (n < most_overlap_points && n * (n - 1) < least) ++n;
    return n;
}

int points_along(const InterfaceLaw& law, double share_of_joint, bool is_of_net) {
    if (law.overlap_points > 0) return law.overlap_points;
    return law.cohesion == 0.0 || is_of_net ? least_overlap_points : points_for(share_of_joint);
}

double length_of(const BlockSystem& system, const Interface& interface) {
    const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
    return (edge_end(system, edge) - edge_start(system, edge)).norm();
}

} // namespace

OverlapRule overlap_rule(int n_points) {
    static const StoredRules rules = all_rules();
    const auto n = static_cast<std::size_t>(n_points);
    return {std::span(rules.at(n).positions).first(n), std::span(rules.at(n).weights).first(n)};
}

int overlap_points_alone(const InterfaceLaw& law) { return points_along(law, 1.0, false); }

std::vector<int> overlap_points(const BlockSystem& system, const std::vector<const InterfaceLaw*>& laws) {
    std::map<int, double> lengths; // of the mapped fractures
    for (const Interface& i : system.interfaces) {
        if (i.fracture >= 0) lengths[i.fracture] += length_of(system, i);
    }
    std::vector<int> points;
    points.reserve(system.interfaces.size());
    for (std::size_t k = 0; k < system.interfaces.size(); ++k) {
        const Interface& i = system.interfaces[k];
        const double share = i.fracture >= 0 ? length_of(system, i) / lengths[i.fracture] : 1.0;
        points.push_back(points_along(*laws[k], share, i.origin == EdgeOrigin::tessellation));
    }
    return points;
}

} // namespace kluft
