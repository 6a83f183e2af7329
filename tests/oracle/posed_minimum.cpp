#include "oracle/posed_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <Eigen/QR>

#include "oracle/ipopt_minimum.hpp"

namespace kluft::oracle {

namespace {

constexpr int unknowns_per_block = 6;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int max_outer_iterations = 200;
constexpr double outer_tolerance = 1e-10; ///< of the change of normal forces, relative to the largest
constexpr double least_force = 1e-11;     ///< of the largest normal force: a smaller one is the barrier's
constexpr double warm_weight = 1e-6;      ///< of the barrier, where the last solution is near

/// Adds factor * direction . u(xi) of a block, eq. (1): unknowns are changes since `start`.
void add_displacement(LinearForm& form, int block, const Vec2& xi, const Vec2& direction, double factor,
                      const Eigen::VectorXd& start) {
    const double weights[] = {1.0, xi.x(), xi.y()};
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 2; ++i) {
            const int unknown = unknowns_per_block * block + 2 * k + i;
            const double coefficient = factor * weights[k] * direction[i];
            if (coefficient == 0.0) continue;
            form.add(unknown, coefficient);
            form.constant += coefficient * start[unknown];
        }
    }
}

/// direction . (u_b(xi_b) - u_a(xi_a)) of a contact point, or of a point of a bond.
LinearForm relative_form(int block_a, const Vec2& xi_a, int block_b, const Vec2& xi_b, const Vec2& direction,
                         const Eigen::VectorXd& start) {
    LinearForm form;
    add_displacement(form, block_b, xi_b, direction, 1.0, start);
    add_displacement(form, block_a, xi_a, direction, -1.0, start);
    return form;
}

/// Eq. (5): normal . (x_b - x_a).
LinearForm gap_form(const ContactPoint& point, const Eigen::VectorXd& start) {
    LinearForm form = relative_form(point.block_a, point.xi_a, point.block_b, point.xi_b, point.normal, start);
    form.constant += point.normal.dot(point.offset);
    return form;
}

/// Eq. (5): slip since the history was kept, plus the elastic slip of the history.
LinearForm slip_form(const ContactPoint& point, double stiffness, const Eigen::VectorXd& start) {
    LinearForm form = relative_form(point.block_a, point.xi_a, point.block_b, point.xi_b, point.tangent, start);
    form.constant += point.tangent.dot(point.offset) - point.slip_start + point.history.shear_trial / stiffness;
    return form;
}

void refuse_what_is_missing(const LoadedBody& body) {
    if (body.loads->platen_force)
        throw std::invalid_argument("a platen loaded by stress is not part of the formulation");
    for (const ContactPoint& point : body.placement->contacts) {
        const InterfaceLaw& law = (*body.laws)[point.law];
        if (law.contact_rounding != 0.0 || law.friction_rounding != 0.0)
            throw std::invalid_argument("rounded laws are not part of the formulation");
        if (law.tan_dilation != 0.0) throw std::invalid_argument("dilation is not part of the formulation");
    }
}

void add_blocks(const LoadedBody& body, const Eigen::VectorXd& start, Potential& potential) {
    for (int b = 0; b < body.system->n_blocks(); ++b) {
        const Block& block = body.system->blocks[b];
        const ElasticModuli& moduli = (*body.moduli)[block.material];
        const int first = unknowns_per_block * b + 2;
        potential.blocks.push_back({first, std::sqrt(block.area), moduli.mu, moduli.lambda, start.segment<4>(first)});
        if (body.densities == nullptr) continue;
        potential.linear.segment<2>(unknowns_per_block * b) -=
            (*body.densities)[block.material] * block.area * body.loads->gravity;
    }
}

void add_bonds(const LoadedBody& body, const Eigen::VectorXd& start, Potential& potential) {
    for (const Bond& bond : body.placement->bonds) {
        const InterfaceLaw& law = (*body.laws)[bond.law];
        const Vec2 normal(bond.tangent.y(), -bond.tangent.x());
        for (std::size_t k = 0; k < bond.xi_a.size(); ++k) {
            const auto form = [&](const Vec2& direction) {
                return relative_form(bond.block_a, bond.xi_a[k], bond.block_b, bond.xi_b[k], direction, start);
            };
            potential.springs.push_back({form(normal), bond.weight * law.normal_stiffness, 0.0});
            LinearForm slip = form(bond.tangent);
            slip.constant -= bond.slip_start[k];
            potential.springs.push_back(
                {std::move(slip), bond.weight * law.shear_stiffness, bond.weight * bond.shear_start[k]});
        }
    }
}

void add_pressures(const LoadedBody& body, const std::vector<Vec2>& forces, Potential& potential) {
    for (std::size_t i = 0; i < body.loads->pressure_edges.size(); ++i) {
        const PressureEdge& edge = body.loads->pressure_edges[i];
        const double weights[] = {1.0, edge.xi_middle.x(), edge.xi_middle.y()};
        for (int k = 0; k < 3; ++k)
            potential.linear.segment<2>(unknowns_per_block * edge.block + 2 * k) -= weights[k] * forces[i];
    }
}

/// Of each block as many prescribed displacements as are independent: the others follow.
void add_conditions(const LoadedBody& body, const Eigen::VectorXd& start, Potential& potential) {
    std::map<int, std::vector<LinearForm>> forms_of_block;
    for (const PrescribedDisplacement& row : body.loads->constraints.rows()) {
        LinearForm form;
        add_displacement(form, row.block, row.xi, row.direction, 1.0, start);
        form.constant -= row.target;
        forms_of_block[row.block].push_back(std::move(form));
    }
    for (const auto& [block, forms] : forms_of_block) {
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(unknowns_per_block, static_cast<Eigen::Index>(forms.size()));
        for (std::size_t i = 0; i < forms.size(); ++i) {
            for (const auto& term : forms[i].terms)
                columns(term.unknown - unknowns_per_block * block, static_cast<Eigen::Index>(i)) = term.factor;
        }
        Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(columns);
        factors.setThreshold(1e-9);
        for (Eigen::Index i = 0; i < factors.rank(); ++i)
            potential.equalities.push_back(forms[static_cast<std::size_t>(factors.colsPermutation().indices()[i])]);
    }
}

double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

/// A first idea of displacements and forces, from loads and stiffnesses.
Scales first_scales(const LoadedBody& body, const Eigen::VectorXd& start, const Lagged& lagged) {
    double stiffness = 0.0;
    for (const auto& moduli : *body.moduli) stiffness = std::max(stiffness, moduli.mu);
    for (const ContactPoint& point : body.placement->contacts)
        stiffness = std::max(stiffness, point.weight * (*body.laws)[point.law].normal_stiffness);
    double force = largest(normal_forces_at(body, start));
    for (const Block& block : body.system->blocks) {
        if (body.densities != nullptr)
            force = std::max(force, (*body.densities)[block.material] * block.area * body.loads->gravity.norm());
    }
    for (const Vec2& pressure : lagged.pressure_forces) force = std::max(force, pressure.norm());
    double motion = 0.0;
    for (const PrescribedDisplacement& row : body.loads->constraints.rows()) {
        LinearForm form;
        add_displacement(form, row.block, row.xi, row.direction, 1.0, start);
        motion = std::max(motion, std::abs(row.target - form.constant));
    }
    if (force == 0.0) force = stiffness * motion;
    return {std::max(motion, force / stiffness), force};
}

/// Changes of the normal forces and of the pressures' between two outer iterations, relative to the largest.
double change_of(const std::vector<double>& before, const std::vector<double>& now, const Lagged& lagged,
                 const std::vector<Vec2>& pressure_forces) {
    double change = 0.0;
    double scale = std::max(largest(now), largest(before));
    for (std::size_t i = 0; i < now.size(); ++i) change = std::max(change, std::abs(now[i] - before[i]));
    for (std::size_t i = 0; i < pressure_forces.size(); ++i) {
        change = std::max(change, (pressure_forces[i] - lagged.pressure_forces[i]).norm());
        scale = std::max(scale, pressure_forces[i].norm());
    }
    return scale > 0.0 ? change / scale : 0.0;
}

std::vector<double> shear_forces_at(const LoadedBody& body, const Eigen::VectorXd& start, const PosedMinimum& posed,
                                    const Lagged& lagged, const Eigen::VectorXd& x) {
    std::vector<double> forces;
    for (std::size_t i = 0; i < body.placement->contacts.size(); ++i) {
        const ContactPoint& point = body.placement->contacts[i];
        const double stiffness = (*body.laws)[point.law].shear_stiffness;
        double elastic = slip_form(point, stiffness, start).at(x);
        if (posed.slips[i] >= 0) elastic += x[posed.slips[i] + 1] - x[posed.slips[i]];
        forces.push_back(lagged.slip_limits[i] > 0.0 ? point.weight * stiffness * elastic : 0.0);
    }
    return forces;
}

double missed_condition(const LoadedBody& body, const Eigen::VectorXd& q) {
    double most = 0.0;
    for (const PrescribedDisplacement& row : body.loads->constraints.rows()) {
        LinearForm form;
        add_displacement(form, row.block, row.xi, row.direction, 1.0, q);
        most = std::max(most, std::abs(row.target - form.constant));
    }
    return most;
}

} // namespace

std::vector<double> normal_forces_at(const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<double> forces;
    for (const ContactPoint& point : body.placement->contacts) {
        const double gap = gap_form(point, q).constant;
        forces.push_back((*body.laws)[point.law].normal_stiffness * point.weight * std::max(0.0, -gap));
    }
    return forces;
}

std::vector<Vec2> pressure_forces_at(const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<Vec2> forces;
    for (const PressureEdge& edge : body.loads->pressure_edges) {
        const double* d = q.data() + unknowns_per_block * edge.block + 2;
        const double along_x = edge.extent.x() + d[0] * edge.xi_extent.x() + d[2] * edge.xi_extent.y();
        const double along_y = edge.extent.y() + d[1] * edge.xi_extent.x() + d[3] * edge.xi_extent.y();
        forces.push_back(body.loads->pressures[edge.boundary] *
                         Vec2(-along_y, along_x)); // inward: the body is on the left
    }
    return forces;
}

/// Integral of min(1, p+/onset) over a piece of the given length along which p is linear: the trapezoids between the places where
/// p is 0 and where it is `onset`.
double cohesive_length(double from, double to, double onset, double length) {
    std::vector<double> places{0.0, 1.0};
    for (const double kink : {0.0, onset}) {
        const double place = (kink - from) / (to - from);
        if (place > 0.0 && place < 1.0) places.push_back(place);
    }
    std::sort(places.begin(), places.end());
    double sum = 0.0;
    for (std::size_t i = 1; i < places.size(); ++i) {
        const double middle = std::lerp(from, to, 0.5 * (places[i - 1] + places[i]));
        const double share = middle >= onset ? (middle > 0.0 ? 1.0 : 0.0) : std::max(0.0, middle / onset);
        sum += share * (places[i] - places[i - 1]);
    }
    return sum * length;
}

/// Per contact the cohesion's part of its limit (N/m): of its piece of the overlap, of a corner that of its own pressure.
std::vector<double> cohesive_limits(const LoadedBody& body, const Eigen::VectorXd& q) {
    const std::vector<ContactPoint>& points = body.placement->contacts;
    const auto pressure = [&](const ContactPoint& point) {
        return -(*body.laws)[point.law].normal_stiffness * gap_form(point, q).constant;
    };
    const auto same_overlap = [](const ContactKey& a, const ContactKey& b) {
        return a.point >= 0 && b.point >= 0 && a.block_a == b.block_a && a.edge_a == b.edge_a &&
               a.block_b == b.block_b && a.edge_b == b.edge_b;
    };
    std::vector<double> limits;
    for (std::size_t first = 0; first < points.size();) {
        std::size_t end = first + 1;
        while (end < points.size() && same_overlap(points[first].key, points[end].key)) ++end;
        const InterfaceLaw& law = (*body.laws)[points[first].law];
        double length = 0.0;
        for (std::size_t i = first; i < end; ++i) length += points[i].weight;
        const double at_start = pressure(points[first]);
        const double at_end = pressure(points[end - 1]);
        double from = 0.0;
        for (std::size_t i = first; i < end; ++i) {
            const double to = from + points[i].weight / length;
            limits.push_back(law.cohesion * cohesive_length(std::lerp(at_start, at_end, from),
                                                            std::lerp(at_start, at_end, to), law.cohesion_onset,
                                                            points[i].weight));
            from = to;
        }
        first = end;
    }
    return limits;
}

std::vector<double> coulomb_limits(const LoadedBody& body, const std::vector<double>& normal_forces,
                                   const Eigen::VectorXd& q) {
    const double least = least_force * largest(normal_forces);
    std::vector<double> limits = cohesive_limits(body, q);
    for (std::size_t i = 0; i < limits.size(); ++i) {
        if (normal_forces[i] > least)
            limits[i] += normal_forces[i] * (*body.laws)[body.placement->contacts[i].law].tan_friction;
    }
    return limits;
}

PosedMinimum pose_minimum(const LoadedBody& body, const Eigen::VectorXd& start, const Lagged& lagged) {
    refuse_what_is_missing(body);
    PosedMinimum posed;
    Potential& potential = posed.potential;
    int n = unknowns_per_block * body.system->n_blocks();
    const int n_contacts = static_cast<int>(body.placement->contacts.size());
    for (int i = 0; i < n_contacts; ++i) posed.closures.push_back(n++);
    for (int i = 0; i < n_contacts; ++i) {
        const bool can_slide = lagged.slip_limits[i] > 0.0 && lagged.slip_limits[i] < infinity;
        posed.slips.push_back(can_slide ? n : -1);
        if (can_slide) n += 2;
    }
    potential.n_unknowns = n;
    potential.linear = Eigen::VectorXd::Zero(n);

    add_blocks(body, start, potential);
    add_bonds(body, start, potential);
    add_pressures(body, lagged.pressure_forces, potential);
    add_conditions(body, start, potential);
    for (int i = 0; i < n_contacts; ++i) {
        const ContactPoint& point = body.placement->contacts[i];
        const InterfaceLaw& law = (*body.laws)[point.law];
        LinearForm closure; // eq. (6)
        closure.add(posed.closures[i], 1.0);
        potential.springs.push_back({closure, point.weight * law.normal_stiffness, 0.0});
        LinearForm condition = gap_form(point, start);
        condition.add(posed.closures[i], 1.0);
        potential.inequalities.push_back(std::move(condition));

        if (lagged.slip_limits[i] <= 0.0) continue;
        LinearForm elastic = slip_form(point, law.shear_stiffness, start); // eq. (7)
        if (posed.slips[i] >= 0) {
            elastic.add(posed.slips[i], -1.0);
            elastic.add(posed.slips[i] + 1, 1.0);
            for (int k = 0; k < 2; ++k) {
                potential.linear[posed.slips[i] + k] = lagged.slip_limits[i];
                potential.nonnegative.push_back(posed.slips[i] + k);
            }
        }
        potential.springs.push_back({std::move(elastic), point.weight * law.shear_stiffness, 0.0});
    }
    return posed;
}

Eigen::VectorXd closest_unknowns(const PosedMinimum& posed, const LoadedBody& body, const Lagged& lagged,
                                 const Eigen::VectorXd& start, const Eigen::VectorXd& q) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(posed.potential.n_unknowns);
    x.head(q.size()) = q - start;
    for (std::size_t i = 0; i < body.placement->contacts.size(); ++i) {
        const ContactPoint& point = body.placement->contacts[i];
        const InterfaceLaw& law = (*body.laws)[point.law];
        x[posed.closures[i]] = std::max(0.0, -gap_form(point, start).at(x));
        if (posed.slips[i] < 0) continue;
        const double elastic = lagged.slip_limits[i] / (point.weight * law.shear_stiffness);
        const double slip = slip_form(point, law.shear_stiffness, start).at(x);
        x[posed.slips[i]] = std::max(0.0, slip - elastic);
        x[posed.slips[i] + 1] = std::max(0.0, -slip - elastic);
    }
    return x;
}

OracleSolution solve_by_minimisation(const LoadedBody& body, const Eigen::VectorXd& start) {
    OracleSolution solution;
    solution.q = start;
    std::vector<double> normal_forces = normal_forces_at(body, start);
    Lagged lagged{coulomb_limits(body, normal_forces, start), pressure_forces_at(body, start)};
    // At first what has friction sticks: limits of the start may be too small to hold the body under larger loads.
    for (std::size_t i = 0; i < body.placement->contacts.size(); ++i) {
        const InterfaceLaw& law = (*body.laws)[body.placement->contacts[i].law];
        if (law.tan_friction > 0.0 || law.cohesion > 0.0) lagged.slip_limits[i] = infinity;
    }
    Scales scales = first_scales(body, start, lagged);
    for (int& k = solution.outer_iterations; k < max_outer_iterations && !solution.converged;) {
        const PosedMinimum posed = pose_minimum(body, start, lagged);
        const Eigen::VectorXd guess = closest_unknowns(posed, body, lagged, start, solution.q);
        const Minimum minimum = minimise(posed.potential, guess, scales, k == 0 ? 0.1 : warm_weight);
        ++k;
        solution.ipopt_iterations += minimum.iterations;
        if (!minimum.converged) {
            solution.diagnosis = "Ipopt ends with status " + minimum.status;
            return solution;
        }
        solution.n_unknowns = posed.potential.n_unknowns;
        solution.q = start + minimum.x.head(start.size());
        solution.normal_forces.assign(minimum.inequality_forces.begin(), minimum.inequality_forces.end());
        solution.shear_forces = shear_forces_at(body, start, posed, lagged, minimum.x);
        solution.energy = posed.potential.energy(minimum.x);
        solution.work_of_slip = 0.0;
        for (const int p : posed.potential.nonnegative)
            solution.work_of_slip += posed.potential.linear[p] * minimum.x[p];

        const auto pressure_forces = pressure_forces_at(body, solution.q);
        solution.last_change = change_of(normal_forces, solution.normal_forces, lagged, pressure_forces);
        solution.converged = k > 1 && solution.last_change <= outer_tolerance;
        normal_forces = solution.normal_forces;
        lagged = {coulomb_limits(body, normal_forces, solution.q), pressure_forces};
        scales = {std::max(minimum.x.head(start.size()).cwiseAbs().maxCoeff(), 1e-6 * scales.length),
                  std::max(largest(normal_forces), 1e-6 * scales.force)};
    }
    solution.missed_condition = missed_condition(body, solution.q);
    if (!solution.converged) solution.diagnosis = "the normal forces keep changing";
    return solution;
}

} // namespace kluft::oracle
