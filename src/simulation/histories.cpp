#include "kluft/simulation/histories.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

namespace {

constexpr std::array block_columns{"displacement_x", "displacement_y", "rotation",
                                   "stress_xx",      "stress_yy",      "stress_xy"};
constexpr std::array contact_columns{"normal_force",        "shear_force", "mean_normal_traction",
                                     "mean_shear_traction", "opening",     "slip"};

bool concerns(const HistoryGauge& gauge, int block_a, int block_b) {
    return std::minmax(block_a, block_b) == std::minmax(gauge.pair.first, gauge.pair.second);
}

bool concerns(const HistoryGauge& gauge, const Interface& interface) {
    if (gauge.fractures.empty()) return concerns(gauge, interface.block_a, interface.block_b);
    return std::ranges::find(gauge.fractures, interface.fracture) != gauge.fractures.end();
}

bool concerns(const HistoryGauge& gauge, const BlockSystem& system, const ContactPoint& point) {
    if (gauge.fractures.empty()) return concerns(gauge, point.block_a, point.block_b);
    const auto lies_on = [&](int block, int edge) {
        const int interface = system.blocks[block].edges[edge].interface;
        return interface >= 0 && concerns(gauge, system.interfaces[interface]);
    };
    return lies_on(point.key.block_a, point.key.edge_a) && lies_on(point.key.block_b, point.key.edge_b);
}

/// u_b - u_a of the place X (local coordinates), as if it belonged to both blocks.
Vec2 relative_displacement(const BlockSystem& system, const Eigen::VectorXd& q, int a, int b, const Vec2& x) {
    const auto moved = [&](int block) { return displacement_at(q, block, block_coordinates(system.blocks[block], x)); };
    return moved(b) - moved(a);
}

struct ContactSum {
    double length = 0.0;
    double normal_force = 0.0; ///< positive in tension
    double shear_force = 0.0;
    double opening = 0.0; ///< times length
    double slip = 0.0;    ///< times length

    void add(double weight, const PointTraction& traction, double gap, double tangential) {
        length += weight;
        normal_force += weight * traction.normal;
        shear_force += weight * traction.shear;
        opening += weight * gap;
        slip += weight * tangential;
    }
};

void add_bonds(const HistoryGauge& gauge, const LoadedBody& body, const Eigen::VectorXd& q, ContactSum& sum) {
    for (const Bond& bond : body.placement->bonds) {
        if (!concerns(gauge, body.system->interfaces[bond.interface])) continue;
        for (int k = 0; k < n_bond_points; ++k) {
            const Vec2 relative = relative_displacement(bond, k, q);
            sum.add(bond.weight, bond_traction((*body.laws)[bond.law], bond, k, q), bond.normal().dot(relative),
                    bond.tangent.dot(relative));
        }
    }
}

void add_contacts(const HistoryGauge& gauge, const LoadedBody& body, const Eigen::VectorXd& q, ContactSum& sum) {
    const BlockSystem& system = *body.system;
    for (const ContactPoint& point : body.placement->contacts) {
        if (!concerns(gauge, system, point)) continue;
        const Block& block = system.blocks[point.block_a];
        const Vec2 x = block.centroid + block.size * point.xi_a;
        const Vec2 relative = relative_displacement(system, q, point.block_a, point.block_b, x);
        sum.add(point.weight, contact_traction(*body.laws, point, q), gap_and_slip(point, q).gap,
                point.tangent.dot(relative));
    }
}

/// Opening and slip where nothing touches.
void add_middles(const HistoryGauge& gauge, const BlockSystem& system, const Eigen::VectorXd& q, ContactSum& sum) {
    for (const Interface& interface : system.interfaces) {
        if (!concerns(gauge, interface)) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        const Vec2 along = current_position(system, q, interface.block_a, edge.end) -
                           current_position(system, q, interface.block_a, edge.start);
        const Vec2 middle = 0.5 * (edge_start(system, edge) + edge_end(system, edge));
        const Vec2 relative = relative_displacement(system, q, interface.block_a, interface.block_b, middle);
        sum.length += along.norm();
        sum.opening += right_normal(along).dot(relative);
        sum.slip += along.dot(relative);
    }
}

void append_contacts(const HistoryGauge& gauge, const LoadedBody& body, const Eigen::VectorXd& q,
                     std::vector<double>& values) {
    ContactSum sum;
    add_bonds(gauge, body, q, sum);
    add_contacts(gauge, body, q, sum);
    if (sum.length == 0.0) add_middles(gauge, *body.system, q, sum);
    const double per_length = sum.length > 0.0 ? 1.0 / sum.length : 0.0;
    const double pressing = 0.0 - sum.normal_force;
    values.insert(values.end(), {pressing, sum.shear_force, per_length * pressing, per_length * sum.shear_force,
                                 per_length * sum.opening, per_length * sum.slip});
}

/// `rigid_stresses`: of all blocks where they are rigid, and follow from the forces on them; else empty.
void append_block(const MaterialPoint& point, const Model& model, const std::vector<Mat2>& rigid_stresses,
                  const Eigen::VectorXd& q, std::vector<double>& values) {
    const Block& block = model.system.blocks[point.block];
    const Vec2 u = displacement_at(q, point.block, point.xi);
    const Mat2 h = displacement_gradient(q, point.block, block.size);
    const Mat2 stress = rigid_stresses.empty() ? cauchy_stress_of_gradient(h, model.moduli[block.material])
                                               : rigid_stresses[point.block];
    values.insert(values.end(), {u.x(), u.y(), std::atan2(h(1, 0) - h(0, 1), 2.0 + h.trace()), 0.0 - stress(0, 0),
                                 0.0 - stress(1, 1), 0.0 - stress(0, 1)});
}

} // namespace

std::vector<HistoryGauge> place_histories(const BlockSystem& system, const std::vector<HistoryRequest>& requests) {
    std::vector<HistoryGauge> gauges;
    for (const HistoryRequest& request : requests) {
        const std::string what = "output.histories." + request.name;
        HistoryGauge gauge{request.name, {}, request.fractures, {-1, -1}};
        if (request.point) {
            gauge.point = material_point(system, request.block, *request.point, what);
        } else if (!request.block.empty()) {
            gauge.point = MaterialPoint{block_called(system, request.block, what), Vec2::Zero()};
        } else if (request.fractures.empty()) {
            gauge.pair = {block_called(system, request.pair.first, what),
                          block_called(system, request.pair.second, what)};
            if (gauge.pair.first == gauge.pair.second)
                throw InputError(what + ".interface: expected two different blocks, found block " +
                                 block_label(system, gauge.pair.first) + " twice");
        }
        gauges.push_back(std::move(gauge));
    }
    return gauges;
}

std::vector<std::string> history_columns(const Model& model) {
    std::vector<std::string> columns;
    for (const HistoryGauge& gauge : model.histories)
        for (const char* column : gauge.point ? block_columns : contact_columns)
            columns.push_back(fmt::format("{}.{}", gauge.name, column));
    return columns;
}

std::vector<double> measure_histories(const Model& model, const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<double> values;
    std::vector<Mat2> rigid_stresses;
    const bool follows_block =
        std::ranges::any_of(model.histories, [](const HistoryGauge& gauge) { return gauge.point.has_value(); });
    if (follows_block && body.kinematics == Kinematics::rigid) rigid_stresses = block_stresses(body, q);
    for (const HistoryGauge& gauge : model.histories) {
        if (gauge.point)
            append_block(*gauge.point, model, rigid_stresses, q, values);
        else
            append_contacts(gauge, body, q, values);
    }
    return values;
}

} // namespace kluft
