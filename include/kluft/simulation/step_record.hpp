// What a run reports of an equilibrium. Stresses and strains positive in compression.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kluft/contact/contact.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/loading/acting_forces.hpp"
#include "kluft/loading/platen.hpp"

namespace kluft {

/// What an explicit run says of its own quality: further columns of its rows. Energies per metre of thickness (J/m),
/// summed since the start of the run: external_work = strain + kinetic + friction + damping + crack + detection
/// energy.
struct MotionRecord {
    double time_steps = 0.0;       ///< so far
    double kinetic_ratio = 0.0;    ///< kinetic over strain energy
    double platen_imbalance = 0.0; ///< difference of the forces on the two platens over the larger one
    double external_work = 0.0;    ///< of pressures, point forces, platens, supports and weight
    double strain_energy = 0.0;    ///< elastic, of blocks and interfaces
    double kinetic_energy = 0.0;
    double friction_energy = 0.0;  ///< lost by slip, dilation included
    double damping_energy = 0.0;   ///< lost by local damping
    double crack_energy = 0.0;     ///< lost when potential cracks broke
    double detection_energy = 0.0; ///< lost (gained: negative) by contacts whose overlap or partner changed
    double energy_error = 0.0;     ///< what is missing in the balance over the largest of its terms
};

/// Share of the net's bonds in the middle half of the body that have failed, from which on the net may be locked.
inline constexpr double locking_share = 0.7;

/// A row of history.csv or equilibria.csv; the members up to `elapsed_s` are its columns, in order. Pa and fractions.
struct StepRecord {
    int step = 0;  ///< through all stages
    int stage = 0; ///< from 0
    double load_factor = 0.0;
    double axial_strain = 0.0;
    double axial_stress = 0.0;
    double lateral_strain = 0.0;
    double lateral_stress = 0.0;
    double differential_stress = 0.0;
    double volumetric_strain = 0.0;
    int cracks_tension = 0; ///< so far
    int cracks_shear = 0;
    int open = 0; ///< interfaces and contacts by state; an interface counts once, by its worst point
    int sliding = 0;
    int locked = 0;
    int open_close_iterations = 0; ///< linear solves of this step, everything included
    int crack_passes = 0;
    double unbalanced_ratio = 0.0; ///< of the mass-like term in F_ref, (27b)
    double balance_error = 0.0;    ///< largest share left over on a block or group (docs/theory.md, (27))
    int jumps = 0;                 ///< so far
    double net_broken = 0.0;       ///< share of the net's bonds in the middle half of the body that have failed
    bool balanced = true;
    double elapsed_s = 0.0;
    std::optional<double> strength_factor; ///< F that strengths are divided by, of runs that reduce them
    std::optional<MotionRecord> motion;    ///< of explicit runs
    std::vector<double> histories;         ///< what the scene follows: further columns of histories.csv
};

enum class CrackMode { tension, shear };

/// A row of cracks.csv.
struct CrackRecord {
    int step = 0;
    int pass = 0;
    int interface = 0;
    double x = 0.0; ///< scene coordinates of the interface's middle before loading (m)
    double y = 0.0;
    CrackMode mode = CrackMode::tension;
    double p1 = 0.0; ///< principal stresses at failure, positive in compression (Pa)
    double p3 = 0.0;
    double axial_strain = 0.0;
};

/// A row of jumps.csv: a motion at fixed loads from where equilibrium was lost to where the body stands again.
struct JumpRecord {
    int step = 0;
    double load_factor = 0.0;
    double released_energy = 0.0; ///< drop of elastic and load potential less the work of friction (J/m)
    double largest_slip = 0.0;    ///< along a contact (m)
    int blocks = 0;               ///< that moved by more than a hundredth of their motion_scale
};

/// Fields at an equilibrium, for pictures, ParaView and programs that balance the blocks.
struct FieldRecord {
    std::vector<Vec2> displacement; ///< of each block's vertices, block after block in the order of Block::edges (m)
    std::vector<Mat2> stress;       ///< Cauchy, positive in tension, one per block (Pa)
    std::vector<double> stress_zz;  ///< across the plane: nu (s_xx + s_yy) in plane strain, 0 in plane stress (Pa)
    struct InterfaceFields {
        bool bonded = false;
        bool broken = false; ///< a potential crack that failed
        CrackMode mode = CrackMode::tension;
        ContactState state = ContactState::locked;
        double normal_traction = 0.0; ///< mean, positive in tension (Pa)
        double shear_traction = 0.0;  ///< mean (Pa)
        double gap = 0.0;             ///< at the middle, positive when open (m)
        double slip = 0.0;            ///< tangential relative displacement at the middle (m)
        Vec2 relative = Vec2::Zero(); ///< displacement of side b against side a at the middle (m)
        Vec2 force = Vec2::Zero();    ///< that side b exerts on side a (N per metre of thickness)
    };
    std::vector<InterfaceFields> interfaces; ///< one per interface of the block system
    std::vector<PlatenFace> platens;         ///< of the stage
    std::vector<ContactForce> contacts;      ///< of all points where blocks meet
    std::vector<SupportForce> supports;      ///< forces from outside the body
};

} // namespace kluft
