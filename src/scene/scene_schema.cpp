#include "kluft/scene/scene_schema.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace kluft {

namespace {

constexpr Range positive{.least = 0.0, .open_below = true};
constexpr Range not_negative{.least = 0.0};
constexpr Range below_ninety{.least = 0.0, .most = 90.0, .open_above = true};
constexpr Range between_zero_and_one{.least = 0.0, .most = 1.0, .open_below = true, .open_above = true};
constexpr Range positive_integer{.least = 1.0, .most = largest_integer};
constexpr Range natural{.least = 0.0, .most = largest_integer};

std::vector<KeyRule> analysis_rules() {
    return {
        {.path = "analysis", .type = KeyType::mapping, .doc = "What is computed."},
        {.path = "analysis.plane",
         .type = KeyType::choice,
         .choices = {"strain", "stress"},
         .fallback = "strain",
         .doc = "Plane strain (a slice of a long body) or plane stress (a thin plate)."},
        {.path = "analysis.integrator",
         .type = KeyType::choice,
         .choices = {"implicit", "explicit"},
         .fallback = "implicit",
         .doc = "How the body moves from one state to the next: `implicit` finds equilibrium in every load step, "
                "`explicit` follows the damped motion in small time steps, as a reference for the other. Of `solver` "
                "it uses `balance` and `max_unbalanced_steps` only. An explicit run cannot be resumed: its saved state "
                "has no "
                "velocities."},
        {.path = "analysis.damping",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 1.0, .open_above = true},
         .fallback = "0.8",
         .doc = "`explicit` only. Local damping: this part of the unbalanced force acts against the velocity of each "
                "unknown."},
        {.path = "analysis.density_scaling",
         .type = KeyType::choice,
         .choices = {"uniform_step", "none"},
         .fallback = "uniform_step",
         .doc = "`explicit` only. `uniform_step` gives every block the inertia with which its own stable time step is "
                "that of all others (weights stay those of the densities, the body keeps its mass); `none` takes the "
                "inertia from the densities."},
        {.path = "analysis.loading_rate",
         .type = KeyType::number,
         .measure = Measure::velocity,
         .range = positive,
         .fallback_note = "at least 10 crossings of the body by an elastic wave per load step, 100 per stage; slower "
                          "while the body is not in balance, and waiting at the end of each load step until it is",
         .doc = "`explicit` only. Constant velocity of platens that are moved by `displacement` or `strain`, in the "
                "time in which the inertia of the blocks counts."},
        {.path = "analysis.crack_check_interval",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "10",
         .doc = "`explicit` only. Time steps between two checks of the potential cracks; `cracks.every` has no "
                "effect."},
        {.path = "analysis.kinematics",
         .type = KeyType::choice,
         .choices = {"affine", "rigid"},
         .fallback = "affine",
         .doc =
             "How a block moves and deforms: `affine` is six unknowns with a uniform strain, `rigid` three (two "
             "displacements and a rotation of any size). In a tessellated body the interfaces of the tessellation take "
             "over the compliance of rigid blocks, so that the body has the same E and nu with both kinds, of "
             "triangles within 1 to 5 % (docs/theory.md, section 5), with mapped joints up to 7 %; of hexagons 1/k_n' "
             "= 1/k_n + d/2K, 1/(k_n' + "
             "k_s') = 1/(k_n + k_s) + d/4G. Where k_s' would not be positive (of hexagons with `poissons_ratio` "
             "of 1/4 or more in plane strain, 1/3 in plane stress, or of more than that on soft interfaces) the "
             "scene is refused, as are blocks of different moduli. Of hexagons mapped fractures keep their stiffness, "
             "as given blocks do. Block stresses, also "
             "for the potential cracks, follow from the forces on the block. For `integrator: implicit` only."},
        {.path = "analysis.gravity",
         .type = KeyType::gravity,
         .measure = Measure::acceleration,
         .range = not_negative,
         .fallback = "0",
         .doc = "Acceleration of gravity: a number >= 0 acts downwards (towards -y), `[gx, gy]` anywhere. Needs "
                "densities."},
    };
}

std::vector<KeyRule> material_rules() {
    return {
        {.path = "materials",
         .type = KeyType::named,
         .required = true,
         .least_items = 1,
         .doc = "Rocks by name. Names are made of letters, digits, `_` and `-`."},
        {.path = "materials.*", .type = KeyType::mapping, .doc = "One rock."},
        {.path = "materials.*.density",
         .type = KeyType::number,
         .measure = Measure::density,
         .range = not_negative,
         .fallback = "0",
         .doc = "Mass density. Required where there is gravity."},
        {.path = "materials.*.youngs_modulus",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = positive,
         .required = true,
         .doc =
             "Young's modulus: of the rock where the tessellation's interface has a `stiffness_ratio`, of the blocks "
             "where its stiffnesses are given."},
        {.path = "materials.*.poissons_ratio",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 0.5, .open_above = true},
         .required = true,
         .doc = "Poisson's ratio, of the same body as `youngs_modulus`."},
        {.path = "materials.*.cohesion",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = not_negative,
         .fallback_note = "no strength",
         .doc = "Cohesion c of the intact rock. The three strengths are given together or not at all; potential cracks "
                "without strengths of their own need them."},
        {.path = "materials.*.friction_angle",
         .type = KeyType::number,
         .measure = Measure::angle,
         .range = below_ninety,
         .fallback_note = "no strength",
         .doc = "Friction angle phi of the intact rock."},
        {.path = "materials.*.tensile_strength",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = not_negative,
         .fallback_note = "no strength",
         .doc =
             "Tensile strength of the intact rock, positive. More than c cot(phi) is reduced to that with a warning."},
    };
}

std::vector<KeyRule> stiffness_rules() {
    return {
        {.path = "interfaces.*.normal_stiffness",
         .type = KeyType::number,
         .measure = Measure::stiffness,
         .range = positive,
         .doc = "Normal stiffness k_n. Together with `shear_stiffness`, and with no other stiffness key."},
        {.path = "interfaces.*.shear_stiffness",
         .type = KeyType::number,
         .measure = Measure::stiffness,
         .range = positive,
         .doc = "Shear stiffness k_s."},
        {.path = "interfaces.*.normal_stiffness_times_spacing",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = positive,
         .doc = "k_n d, with d the tessellation's spacing, or `geometry.reference_spacing` without a tessellation: the "
                "same body on any spacing. Together with `shear_stiffness_times_spacing`, and with no other stiffness "
                "key."},
        {.path = "interfaces.*.shear_stiffness_times_spacing",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = positive,
         .doc = "k_s d."},
        {.path = "interfaces.*.stiffness_ratio",
         .type = KeyType::number,
         .range = positive,
         .fallback_note =
             "10, of a net of triangles 30, where no other stiffness key is given; none on mapped fractures",
         .doc = "k_n d/E with E of the material, of several in the body the largest. With it `youngs_modulus` and "
                "`poissons_ratio` are those of the rock: "
                "the blocks' own moduli follow so that the tessellated body has them. Of a net of triangles 10 to 60, "
                "of hexagons or Voronoi cells 5 to 20 is the good range, however the stiffness is given: below, the "
                "joints carry most of the deformation; above, affine hexagons are too stiff in bending, and a body "
                "without strength noise fails everywhere at once."},
        {.path = "interfaces.*.shear_ratio",
         .type = KeyType::number,
         .range = positive,
         .fallback_note = "0.5, where no other stiffness key is given",
         .doc = "k_s/k_n, together with `stiffness_ratio`."},
    };
}

std::vector<KeyRule> interface_rules() {
    std::vector<KeyRule> rules{
        {.path = "interfaces",
         .type = KeyType::named,
         .doc = "Kinds of interfaces between blocks, by name. Stiffness is given in one of three ways: "
                "`normal_stiffness` and `shear_stiffness`; or the same two `..._times_spacing`; or `stiffness_ratio` "
                "and `shear_ratio`. That of mapped fractures, and of what they fail to, has to be given: it is the "
                "joint's and does not follow from the net."},
        {.path = "interfaces.*", .type = KeyType::mapping, .doc = "One kind of interface."},
        {.path = "interfaces.*.kind",
         .type = KeyType::choice,
         .choices = {"fracture", "potential_crack"},
         .required = true,
         .doc = "`fracture`: Coulomb friction, no tension. `potential_crack`: bonded and elastic until it fails, then "
                "the fracture named by `fails_to`."},
    };
    const auto stiffness = stiffness_rules();
    rules.insert(rules.end(), stiffness.begin(), stiffness.end());
    const std::vector<KeyRule> strength{
        {.path = "interfaces.*.friction_angle",
         .type = KeyType::number,
         .measure = Measure::angle,
         .range = below_ninety,
         .fallback = "0",
         .doc = "Friction angle: of Coulomb's law for a fracture, of the strength for a potential crack."},
        {.path = "interfaces.*.cohesion",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = not_negative,
         .fallback = "0",
         .doc = "Cohesion: of Coulomb's law for a fracture, of the strength for a potential crack."},
        {.path = "interfaces.*.tensile_strength",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = not_negative,
         .fallback_note = "that of the weaker adjacent material",
         .doc = "Tensile strength of a potential crack, positive; a fracture has none. A potential crack gives "
                "`cohesion`, `friction_angle` and `tensile_strength` together, or none of them and takes those of the "
                "weaker adjacent material."},
        {.path = "interfaces.*.dilation_angle",
         .type = KeyType::number,
         .measure = Measure::angle,
         .range = below_ninety,
         .fallback = "0",
         .doc =
             "Opening per slip of a fracture, as an angle; not above the friction angle. Slip that turns back opens it "
             "further. It adds no strength to that of `friction_angle`, which is the whole angle at the peak: the "
             "shear "
             "stress reaches the normal stress times tan(friction_angle) plus `cohesion` with any dilation. Only where "
             "the opening is hindered the normal stress grows, and the strength with it."},
        {.path = "interfaces.*.fails_to",
         .type = KeyType::text,
         .fallback_note = "the only fracture among the interfaces",
         .doc = "Interface (of kind fracture) whose law a potential crack follows after its failure."},
        {.path = "interfaces.*.cohesion_onset",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = not_negative,
         .fallback_note = "0.01 c",
         .doc = "t_r: a fracture's cohesion grows linearly from 0 at opening to its full value at this compressive "
                "normal traction. Larger values ease convergence and weaken fractures under small stress."},
        {.path = "interfaces.*.contact_rounding",
         .type = KeyType::number,
         .measure = Measure::stress,
         .range = not_negative,
         .fallback_note = "1e-3 of the largest boundary or self-weight stress (of given blocks that of the smallest "
                          "one), or point force "
                          "over the size of its block",
         .doc = "g_0 k_n: normal traction over which the corner between open and closed is rounded; 0 for none."},
        {.path = "interfaces.*.overlap_points",
         .type = KeyType::integer,
         .range = {.least = 3.0, .most = 15.0},
         .fallback_note = "3, of joints with cohesion up to 15",
         .doc = "Points along an overlap of two blocks. Three are exact where it is closed, and a hinge in the corner, "
                "as of rigid blocks, where it is open over a part; 15 make it an elastic foundation of its normal "
                "stiffness (rotation within 2 % while 30 % of it is closed), on which slender blocks turn over "
                "earlier."},
        {.path = "interfaces.*.friction_rounding",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 0.5},
         .fallback = "0.05",
         .doc = "Half-width of the rounding between stick and slip, as a fraction of the friction limit; 0 for none."},
    };
    rules.insert(rules.end(), strength.begin(), strength.end());
    return rules;
}

std::vector<KeyRule> domain_rules() {
    return {
        {.path = "geometry", .type = KeyType::mapping, .required = true, .doc = "The body and its cuts."},
        {.path = "geometry.domain",
         .type = KeyType::mapping,
         .doc = "The outline of a body that is cut: one of `rectangle`, `polygon` and `file`. Either `domain` or "
                "`blocks`."},
        {.path = "geometry.domain.rectangle",
         .type = KeyType::mapping,
         .doc = "An upright rectangle. Its boundaries are named `bottom`, `right`, `top` and `left`."},
        {.path = "geometry.domain.rectangle.width",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .required = true,
         .doc = "Extent in x."},
        {.path = "geometry.domain.rectangle.height",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .required = true,
         .doc = "Extent in y."},
        {.path = "geometry.domain.rectangle.origin",
         .type = KeyType::point,
         .measure = Measure::length,
         .fallback = "[0, 0]",
         .doc = "Lower left corner."},
        {.path = "geometry.domain.polygon",
         .type = KeyType::points,
         .measure = Measure::length,
         .least_items = 3,
         .doc = "Corners of a simple polygon in order, either way round. Side i of it goes from corner i to the next, "
                "counted from 0."},
        {.path = "geometry.domain.holes",
         .type = KeyType::list,
         .least_items = 1,
         .doc = "Openings in the body, beside `rectangle` or `polygon`. Those of a map are in its polygon."},
        {.path = "geometry.domain.holes.#", .type = KeyType::mapping, .doc = "One of them."},
        {.path = "geometry.domain.holes.#.polygon",
         .type = KeyType::points,
         .measure = Measure::length,
         .required = true,
         .least_items = 3,
         .doc =
             "Corners of a simple polygon that lies in the domain and touches neither its outline nor another hole."},
        {.path = "geometry.domain.file",
         .type = KeyType::text,
         .doc = "Map with one polygon (and its holes), relative to the scene file: GeoJSON, GeoPackage (`.gpkg`) or "
                "shapefile (`.shp`)."},
        {.path = "geometry.domain.layer",
         .type = KeyType::text,
         .fallback_note = "the only layer",
         .doc = "Layer of a GeoPackage."},
        {.path = "geometry.domain.file_crs",
         .type = KeyType::text,
         .fallback_note = "what the file says",
         .doc =
             "Coordinate system of the file, for one that says none or a wrong one; `local`: its coordinates are those "
             "of the scene, in metres."},
        {.path = "geometry.crs",
         .type = KeyType::text,
         .fallback_note = "that of the maps",
         .doc =
             "Coordinate system of the scene's coordinates, in metres, such as `EPSG:25832`. Maps in another one are "
             "projected to it."},
    };
}

std::vector<KeyRule> cut_rules() {
    return {
        {.path = "geometry.fractures", .type = KeyType::list, .fallback = "[]", .doc = "Mapped fractures."},
        {.path = "geometry.fractures.#", .type = KeyType::mapping, .doc = "One trace, or one file of traces."},
        {.path = "geometry.fractures.#.name",
         .type = KeyType::text,
         .fallback_note = "`fracture 1`, `fracture 2`, ...",
         .doc = "For messages and output."},
        {.path = "geometry.fractures.#.trace",
         .type = KeyType::points,
         .measure = Measure::length,
         .least_items = 2,
         .doc = "Points of a polyline. What lies outside the domain is clipped, dangling ends are pruned. Either "
                "`trace` or `file`."},
        {.path = "geometry.fractures.#.file",
         .type = KeyType::text,
         .doc = "Map with the traces as lines, relative to the scene file: GeoJSON, GeoPackage (`.gpkg`) or shapefile "
                "(`.shp`)."},
        {.path = "geometry.fractures.#.layer",
         .type = KeyType::text,
         .fallback_note = "the only layer",
         .doc = "Layer of a GeoPackage."},
        {.path = "geometry.fractures.#.file_crs",
         .type = KeyType::text,
         .fallback_note = "what the file says",
         .doc = "As that of the domain."},
        {.path = "geometry.fractures.#.interface",
         .type = KeyType::text,
         .fallback_note = "the only interface",
         .doc = "Kind of interface along the trace; beside `attribute`, along traces whose value names none."},
        {.path = "geometry.fractures.#.attribute",
         .type = KeyType::text,
         .doc = "Attribute of the map's features whose value chooses the kind of interface of a trace."},
        {.path = "geometry.fractures.#.interfaces",
         .type = KeyType::list,
         .fallback_note = "values are names of interfaces",
         .doc = "Kinds of interfaces by the value of `attribute`."},
        {.path = "geometry.fractures.#.interfaces.#", .type = KeyType::mapping, .doc = "One value."},
        {.path = "geometry.fractures.#.interfaces.#.value",
         .type = KeyType::text,
         .required = true,
         .doc = "As the map has it."},
        {.path = "geometry.fractures.#.interfaces.#.interface",
         .type = KeyType::text,
         .required = true,
         .doc = "Kind of interface along its traces."},
        {.path = "geometry.tessellation",
         .type = KeyType::mapping,
         .fallback_note = "none",
         .doc = "A net of triangles, regular hexagons or Voronoi cells between the fractures."},
        {.path = "geometry.tessellation.hexagons",
         .type = KeyType::mapping,
         .doc = "A net of regular hexagons. One of `triangles`, `hexagons` and `voronoi`."},
        {.path = "geometry.tessellation.hexagons.spacing",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .required = true,
         .doc = "d: distance of centres, which is also the distance across flats."},
        {.path = "geometry.tessellation.hexagons.rotation",
         .type = KeyType::number,
         .measure = Measure::angle,
         .fallback = "0",
         .doc = "Counter-clockwise; at 0 the flats are vertical."},
        {.path = "geometry.tessellation.hexagons.offset",
         .type = KeyType::point,
         .measure = Measure::length,
         .fallback = "[0, 0]",
         .doc = "Of one hexagon's centre from the lower left corner of the domain's box."},
        {.path = "geometry.tessellation.hexagons.jitter",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 0.25, .open_above = true},
         .fallback = "0",
         .doc = "Largest random displacement of a vertex as a fraction of the spacing."},
        {.path = "geometry.tessellation.hexagons.seed",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 9007199254740991.0},
         .fallback = "1",
         .doc = "Of the jitter: the same seed gives the same net."},
        {.path = "geometry.tessellation.voronoi",
         .type = KeyType::mapping,
         .doc = "A net of Voronoi cells of random points, without the hexagons' few directions. Their faces interlock "
                "less regularly and are of all lengths, and lock all the same where all bonds have failed to joints of "
                "high "
                "friction; the body has the rock's moduli only nearly (docs/theory.md)."},
        {.path = "geometry.tessellation.voronoi.spacing",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .required = true,
         .doc = "d: the mean area of a cell is that of a hexagon of this spacing, sqrt(3)/2 d^2."},
        {.path = "geometry.tessellation.voronoi.seed",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 9007199254740991.0},
         .fallback = "1",
         .doc = "Of the points: the same seed gives the same net, on every machine."},
        {.path = "geometry.tessellation.voronoi.offset",
         .type = KeyType::point,
         .measure = Measure::length,
         .fallback = "[0, 0]",
         .doc = "Of the net, which covers the plane, from the lower left corner of the domain's box."},
        {.path = "geometry.tessellation.voronoi.relaxation",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 20.0},
         .fallback = "2",
         .doc = "Lloyd's passes: each moves every point to the centroid of its cell. More of them make the cells "
                "rounder and more equal; with none there are many short edges."},
        {.path = "geometry.tessellation.triangles",
         .type = KeyType::mapping,
         .doc =
             "A net of triangles that follows the outline, the mapped fractures to their ends and the construction "
             "lines. Its faces do not interlock, so that the strength is the rock's: the net to take for rock that may "
             "break anywhere (docs/theory.md)."},
        {.path = "geometry.tessellation.triangles.spacing",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .required = true,
         .doc = "a: side of the equilateral triangle of mean area, sqrt(3)/4 a^2. The d of `stiffness_ratio` and "
                "`..._times_spacing`."},
        {.path = "geometry.tessellation.triangles.seed",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 9007199254740991.0},
         .fallback = "1",
         .doc =
             "Of the random points that are joined: the same seed gives the same body the same net. A body that lies "
             "elsewhere, or has one more trace, may have quite another net with it."},
        {.path = "geometry.tessellation.triangles.relaxation",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 20.0},
         .fallback = "0",
         .doc = "Lloyd's passes: each moves every free point to the centroid of its Voronoi cell, which makes the "
                "triangles more equal and the net less random."},
        {.path = "geometry.tessellation.triangles.grading",
         .type = KeyType::mapping,
         .fallback_note = "triangles of one size",
         .doc = "Finer triangles at some places."},
        {.path = "geometry.tessellation.triangles.grading.fractures",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .fallback_note = "`spacing`",
         .doc = "Side of triangles at mapped fractures."},
        {.path = "geometry.tessellation.triangles.grading.openings",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .fallback_note = "`spacing`",
         .doc = "Side of triangles at holes of the domain."},
        {.path = "geometry.tessellation.triangles.grading.region",
         .type = KeyType::points,
         .measure = Measure::length,
         .fallback_note = "none",
         .least_items = 3,
         .doc = "Polygon inside which triangles have the side `region_spacing`."},
        {.path = "geometry.tessellation.triangles.grading.region_spacing",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .fallback_note = "required with `region`",
         .doc = "Side of triangles inside `region`."},
        {.path = "geometry.tessellation.triangles.grading.growth",
         .type = KeyType::number,
         .range = positive,
         .fallback = "0.3",
         .doc = "By how much the side grows per metre away from there, until it is `spacing`."},
        {.path = "geometry.tessellation.interface",
         .type = KeyType::text,
         .fallback_note = "the only interface",
         .doc = "Kind of interface along the edges of the net."},
        {.path = "geometry.tessellation.region",
         .type = KeyType::points,
         .measure = Measure::length,
         .fallback_note = "everywhere",
         .least_items = 3,
         .doc = "Polygon inside which there is a net: whole cells with their centre in it; triangles follow it."},
        {.path = "geometry.construction_lines",
         .type = KeyType::list,
         .fallback = "[]",
         .doc = "Lines that a net of triangles follows without being fractures: its edges there are the net's."},
        {.path = "geometry.construction_lines.#", .type = KeyType::mapping, .doc = "One line."},
        {.path = "geometry.construction_lines.#.trace",
         .type = KeyType::points,
         .measure = Measure::length,
         .required = true,
         .least_items = 2,
         .doc = "Points of a polyline."},
        {.path = "geometry.reference_spacing",
         .type = KeyType::number,
         .measure = Measure::length,
         .range = positive,
         .fallback_note = "none",
         .doc = "d for `..._times_spacing` and `stiffness_ratio` where there is no tessellation. It is also the length "
                "that gaps and motions "
                "are measured by, and a fiftieth of it the smallest that the cut resolves; best about the size of the "
                "blocks."},
        {.path = "geometry.minimum_area",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 0.5},
         .fallback_note = "0.05 with a tessellation, else 0.002",
         .doc = "Pieces smaller than this fraction of a hexagon, of a mean Voronoi cell or triangle, or of the body "
                "where that is "
                "smaller, are merged with a neighbour; those that would lock a fracture which comes out at a free side "
                "(one of no "
                "boundary) are taken off. Between fractures a net of triangles also merges what is narrower "
                "than 0.05 of its smallest side, whatever this is. With neither a net nor `geometry.reference_spacing` "
                "only pieces below 1e-8 of the body are merged."},
        {.path = "geometry.material",
         .type = KeyType::text,
         .fallback_note = "the only material",
         .doc = "Material of the body."},
        {.path = "geometry.regions", .type = KeyType::list, .fallback = "[]", .doc = "Parts made of another material."},
        {.path = "geometry.regions.#", .type = KeyType::mapping, .doc = "One part."},
        {.path = "geometry.regions.#.polygon",
         .type = KeyType::points,
         .measure = Measure::length,
         .required = true,
         .least_items = 3,
         .doc = "Blocks with their centroid inside belong to it: a net of triangles follows it where "
                "`construction_lines` lie along it, and else "
                "its sides are ragged."},
        {.path = "geometry.regions.#.material", .type = KeyType::text, .required = true, .doc = "Its material."},
    };
}

std::vector<KeyRule> block_rules() {
    return {
        {.path = "geometry.blocks",
         .type = KeyType::list,
         .least_items = 1,
         .doc =
             "Blocks given as polygons, instead of a body that is cut (`domain`, `fractures`, `tessellation`, "
             "`regions`). They must not overlap; gaps are allowed. Where two of them share a part of an edge there is "
             "an interface: coordinates that agree within 1e-9 of the body's diagonal are the same, and edges are "
             "split where a corner of a neighbour lies on them. Corners rounded to fewer digits make gaps or overlaps, "
             "so give sloping edges all digits. `minimum_area` has no effect on given blocks."},
        {.path = "geometry.blocks.#", .type = KeyType::mapping, .doc = "One block."},
        {.path = "geometry.blocks.#.name",
         .type = KeyType::text,
         .fallback_note = "`block 1`, `block 2`, ...",
         .doc = "Each once; for messages, boundaries, sets, forces and histories."},
        {.path = "geometry.blocks.#.polygon",
         .type = KeyType::points,
         .measure = Measure::length,
         .required = true,
         .least_items = 3,
         .doc = "Corners of a simple polygon in order, either way round."},
        {.path = "geometry.blocks.#.material",
         .type = KeyType::text,
         .fallback_note = "`geometry.material`, else the only material",
         .doc = "Its material."},
        {.path = "geometry.blocks.#.support",
         .type = KeyType::choice,
         .choices = {"none", "fixed"},
         .fallback = "none",
         .doc = "A `fixed` block does not move or deform, in any stage, and has no weight; two of them do not touch."},
        {.path = "geometry.blocks_interface",
         .type = KeyType::text,
         .fallback_note = "the only interface",
         .doc = "Kind of interface between given blocks, also where they come to touch later."},
        {.path = "geometry.sets",
         .type = KeyType::named,
         .doc = "Blocks by name, also of a body that is cut. The name of a given block counts as a set of that block."},
        {.path = "geometry.sets.*", .type = KeyType::mapping, .doc = "One set: `polygon` or `blocks`."},
        {.path = "geometry.sets.*.polygon",
         .type = KeyType::points,
         .measure = Measure::length,
         .least_items = 3,
         .doc = "Blocks with their centroid inside belong to it: a net of triangles follows it where "
                "`construction_lines` lie along it, and else "
                "its sides are ragged."},
        {.path = "geometry.sets.*.blocks", .type = KeyType::texts, .least_items = 1, .doc = "Names of given blocks."},
        {.path = "geometry.sets.*.support",
         .type = KeyType::choice,
         .choices = {"none", "fixed"},
         .fallback = "none",
         .doc = "As of a given block."},
    };
}

std::vector<KeyRule> loading_rules() {
    return {
        {.path = "boundaries",
         .type = KeyType::named,
         .fallback_note = "free outline",
         .doc =
             "Named parts of the outline. A rectangle has `bottom`, `right`, `top`, `left`, and here they only get "
             "supports. Any other domain has the same four (each side belongs to the direction that its outward "
             "normal points to, within 45 degrees) unless a boundary here has `sides` or `facing`; then exactly "
             "the boundaries given here exist, and sides in none of them are free. Walls of holes are boundaries "
             "where one here has `hole`. `kluft check` lists them. Of given blocks the same holds "
             "for all sides, of which the parts that no other block shares belong to the boundary; and of a boundary "
             "without a `block`, where it has a support or a load, none that has another block straight before it, "
             "within "
             "5 % of the smaller one's size (the square root of its area), or lies beside that by as little, nor what "
             "juts out by 1 % of it beside a shared edge. A warning says what was left out."},
        {.path = "boundaries.*", .type = KeyType::mapping, .doc = "One boundary."},
        {.path = "boundaries.*.support",
         .type = KeyType::choice,
         .choices = {"none", "smooth", "pinned", "fixed"},
         .fallback = "none",
         .doc =
             "Held in every stage: `smooth` against motion normal to the boundary, `pinned` as "
             "smooth and with one vertex near the middle held along the boundary too, so that a body between smooth "
             "platens cannot drift, `fixed` against any motion. All of them hold in tension, too: where rock may "
             "part from "
             "what is behind it, a fixed block beside a joint holds it (`geometry.blocks`), or nothing does. An affine "
             "block whose held corners do not lie in one line cannot deform, and has stress 0: `check` warns of it."},
        {.path = "boundaries.*.sides",
         .type = KeyType::integers,
         .range = natural,
         .least_items = 1,
         .doc =
             "Sides of the domain's polygon, or of that of `block`, that belong to it, counted from 0 as the polygon "
             "is given. Not for rectangles."},
        {.path = "boundaries.*.facing",
         .type = KeyType::choice,
         .choices = {"left", "right", "top", "bottom"},
         .doc =
             "All sides whose outward normal points within 45 degrees of this direction (at exactly 45 degrees it is "
             "`top` or `bottom`); with `block` only those of that block, without it those that no boundary with a "
             "`block` has. Not for rectangles."},
        {.path = "boundaries.*.hole",
         .type = KeyType::integer,
         .range = natural,
         .doc = "The wall of this hole of the domain, counted from 0 as `geometry.domain.holes` or the map's polygon "
                "gives them. A pressure on it acts on the rock; it may be `fixed`, but has no platen and no other "
                "support, since it faces all ways."},
        {.path = "boundaries.*.block",
         .type = KeyType::text,
         .fallback_note = "all blocks",
         .doc = "The given block whose free sides belong to it, beside `facing` or `sides`."},
        {.path = "stages",
         .type = KeyType::list,
         .required = true,
         .least_items = 1,
         .doc = "Loading, one stage after the other. Pressures, strains, stresses and displacements are positive in "
                "compression (inward) and grow linearly over the steps of a stage."},
        {.path = "stages.#",
         .type = KeyType::mapping,
         .doc = "One stage: pressures, forces, gravity and a platen, or some of them; or a reduction of strengths."},
        {.path = "stages.#.name",
         .type = KeyType::text,
         .fallback_note = "`stage 0`, `stage 1`, ...",
         .doc = "For messages and output."},
        {.path = "stages.#.pressure",
         .type = KeyType::named,
         .doc = "Pressure on boundaries by name. It follows the surface, and does not act in joints that come out "
                "there; boundaries not named keep theirs."},
        {.path = "stages.#.pressure.*",
         .type = KeyType::number,
         .measure = Measure::stress,
         .doc = "At the end of the stage."},
        {.path = "stages.#.gravity",
         .type = KeyType::gravity,
         .measure = Measure::acceleration,
         .range = not_negative,
         .fallback_note = "that of the stage before; in the first stage `analysis.gravity`",
         .doc = "Acceleration of gravity at the end of the stage, as `analysis.gravity`; it changes linearly over the "
                "stage. A tilt test is a stage that turns `[gx, gy]`."},
        {.path = "stages.#.forces",
         .type = KeyType::named,
         .doc =
             "Dead loads by name: forces of constant direction on points of blocks. They grow linearly over the stage "
             "from their value at the end of the stage before (0 if new); forces not named keep theirs."},
        {.path = "stages.#.forces.*", .type = KeyType::mapping, .doc = "One force."},
        {.path = "stages.#.forces.*.block",
         .type = KeyType::text,
         .fallback_note = "the block that has the point in it",
         .doc = "Name of a given block, or of a set of exactly one block."},
        {.path = "stages.#.forces.*.point",
         .type = KeyType::point,
         .measure = Measure::length,
         .fallback_note = "where the force acts in the stages before",
         .doc = "Material point of the block that it acts on, in the body as cut. It stays the same in later stages."},
        {.path = "stages.#.forces.*.force",
         .type = KeyType::point,
         .measure = Measure::line_force,
         .required = true,
         .doc = "[fx, fy] at the end of the stage, per metre of thickness."},
        {.path = "stages.#.displacement",
         .type = KeyType::mapping,
         .doc =
             "A platen moves a boundary; the opposite one (`against`) rests on a fixed platen. One of `displacement`, "
             "`strain` "
             "and `stress`. In a later stage with none of them the mean stress on each of both boundaries acts on as a "
             "pressure, and goes on doing so until a stage changes it."},
        {.path = "stages.#.displacement.boundary", .type = KeyType::text, .required = true, .doc = "What is moved."},
        {.path = "stages.#.displacement.value",
         .type = KeyType::number,
         .measure = Measure::length,
         .required = true,
         .doc = "Inward displacement in this stage."},
        {.path = "stages.#.displacement.against",
         .type = KeyType::text,
         .fallback_note = "the opposite boundary",
         .doc = "The boundary that rests on a fixed platen meanwhile, or `none`. The opposite one is that whose normal "
                "is most "
                "opposite, within 60 degrees, the first where several are; `kluft check` names it."},
        {.path = "stages.#.displacement.glued",
         .type = KeyType::boolean,
         .fallback = "false",
         .doc = "Both platens hold the body in tension too."},
        {.path = "stages.#.strain", .type = KeyType::mapping, .doc = "The same, given as engineering strain."},
        {.path = "stages.#.strain.boundary", .type = KeyType::text, .required = true, .doc = "What is moved."},
        {.path = "stages.#.strain.value",
         .type = KeyType::number,
         .range = {.least = -0.5, .most = 0.5},
         .required = true,
         .doc = "Displacement in this stage as a fraction of the body's length, from the boundary to the one across "
                "from it, or, where none is, to the farthest point of the body behind it."},
        {.path = "stages.#.strain.against",
         .type = KeyType::text,
         .fallback_note = "the opposite boundary",
         .doc = "The boundary that rests on a fixed platen meanwhile, or `none`."},
        {.path = "stages.#.strain.glued",
         .type = KeyType::boolean,
         .fallback = "false",
         .doc = "Both platens hold the body in tension too."},
        {.path = "stages.#.stress", .type = KeyType::mapping, .doc = "The same, controlled by the platen's stress."},
        {.path = "stages.#.stress.boundary", .type = KeyType::text, .required = true, .doc = "What is moved."},
        {.path = "stages.#.stress.value",
         .type = KeyType::number,
         .measure = Measure::stress,
         .required = true,
         .doc = "Stress on the platen at the end of the stage: its force over the current mean width of the body, or "
                "over the sides that it "
                "is laid on where these are wider."},
        {.path = "stages.#.stress.against",
         .type = KeyType::text,
         .fallback_note = "the opposite boundary",
         .doc = "The boundary that rests on a fixed platen meanwhile, or `none`."},
        {.path = "stages.#.stress.glued",
         .type = KeyType::boolean,
         .fallback = "false",
         .doc = "Both platens hold the body in tension too."},
        {.path = "stages.#.platens",
         .type = KeyType::choice_or_mapping,
         .choices = {"smooth", "rough"},
         .fallback = "smooth",
         .doc = "Platens are rigid half-planes that the body touches and leaves and that no block enters, but for a "
                "corner "
                "between two faces, which is rounded by 0.5 % of its block's spacing. They are laid on "
                "the sides of their boundary as these lie at the start, even or not, but on none that has the body "
                "before it, as "
                "in an opening. `smooth` ones leave the tangential motion free, to `rough` ones the body sticks where "
                "it touches them, and on those with a "
                "friction_angle it slides by Coulomb's law. The platen opposite to the moved one is rough where its "
                "boundary has a `fixed` support, and one vertex near its middle does not move along it if it is smooth "
                "and has no `smooth` support, unless a support holds the body in that direction. Only in a stage that "
                "moves a boundary."},
        {.path = "stages.#.platens.friction_angle",
         .type = KeyType::number,
         .measure = Measure::angle,
         .range = below_ninety,
         .required = true,
         .doc = "Of the platens against the body."},
        {.path = "stages.#.strength_reduction",
         .type = KeyType::mapping,
         .doc = "Seeks the factor of safety. Loads stay; tan(phi) and cohesion of fractures, and of the strength of "
                "potential cracks, are divided by a factor that grows over the steps of the stage. Where a step finds "
                "no equilibrium, or one to which a block has moved at once by more than a hundredth of its size or by "
                "more than five times as far as "
                "all before, the factor "
                "between the last one that stands and the first one that does not is found "
                "by halving, and the run ends (`collapsed`, exit 0) with `factor_of_safety` in summary.json: null, "
                "with a warning, if the body stands at `to`; a stage after it has the full strengths again. Tensile "
                "strengths stay; dilation is cut to the friction "
                "that is left. The ground before the toe of a slope, which holds the tip of a wedge under loads, "
                "counts for "
                "nothing here, nor does a corner that has caught. Not in the first stage, and for `integrator: "
                "implicit` only. `solver.balance` is at "
                "most a tenth, `solver.tolerance` a hundredth of its tolerance here."},
        {.path = "stages.#.strength_reduction.from",
         .type = KeyType::number,
         .range = positive,
         .fallback = "1",
         .doc = "Factor at the start of the stage, and in the stages before it (since an earlier reduction). Less than "
                "1 strengthens: for bodies that would not stand under their loads."},
        {.path = "stages.#.strength_reduction.to",
         .type = KeyType::number,
         .range = positive,
         .required = true,
         .doc = "Factor at the end of the stage, more than `from`."},
        {.path = "stages.#.strength_reduction.tolerance",
         .type = KeyType::number,
         .range = between_zero_and_one,
         .fallback = "1e-4",
         .doc = "Of the factor of safety, relative."},
        {.path = "stages.#.strength_reduction.interfaces",
         .type = KeyType::list,
         .fallback_note = "all",
         .least_items = 1,
         .doc =
             "Interfaces whose strengths are divided, of which at least one occurs in the body, or a warning says so."},
        {.path = "stages.#.strength_reduction.interfaces.#",
         .type = KeyType::text,
         .required = true,
         .doc = "Name of an interface."},
        {.path = "stages.#.steps",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "1",
         .doc = "Load steps of the stage."},
        {.path = "stages.#.stop_after_drop",
         .type = KeyType::number,
         .range = between_zero_and_one,
         .fallback_note = "all steps of the stage are taken",
         .doc =
             "For the strength without the collapse, which may take most of the time: the run ends, as `done`, after "
             "the first balanced load step of the stage whose axial stress is by this part below the largest one of "
             "the stage; steps and stages that are left are not run. From 1 % on the peak counts as reached. Only in "
             "a stage with a `displacement` or a `strain` of the boundary that the first platen moves. A run that "
             "has ended so goes on when it is resumed without it."},
    };
}

std::vector<KeyRule> option_rules() {
    return {
        {.path = "cracks", .type = KeyType::mapping, .doc = "How potential cracks fail."},
        {.path = "cracks.criterion",
         .type = KeyType::choice,
         .choices = {"principal_stress", "interface_traction"},
         .fallback = "principal_stress",
         .doc = "Compared with the strength: the mean stress of the two adjacent blocks, or the interface's own "
                "traction. They are not interchangeable. Bending of a single bond does not count."},
        {.path = "cracks.update",
         .type = KeyType::choice,
         .choices = {"event", "critical_first", "all", "single"},
         .fallback = "event",
         .doc = "`event` cuts the step where the first potential crack fails. At the end of a step, again and again, "
                "`all` fails those with f >= 1, `critical_first` those with f >= 0.95 f_max, `single` the worst one."},
        {.path = "cracks.every",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "1",
         .doc = "Load steps from one check to the next, of which each stage's last one has one, too. Between them no "
                "potential "
                "crack fails, whatever the stress: with more than 1 strengths come out too large by what the stresses "
                "grow meanwhile, and a run says where that is more than 10 %."},
        {.path = "cracks.event_tolerance",
         .type = KeyType::number,
         .range = between_zero_and_one,
         .fallback = "2.5e-3",
         .doc = "Of f at an event, which is then above 1 by as much at most: strengths come out up to twice that too "
                "large. Cracks within it of the foremost fail together."},
        {.path = "cracks.strength_noise",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 0.3, .open_above = true},
         .fallback = "0",
         .doc =
             "Relative standard deviation of the strengths: cohesion and tensile strength of each potential crack are "
             "multiplied by one log-normal number of mean 1. For replicas that show the scatter of a result."},
        {.path = "cracks.strength_seed",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 9007199254740991.0},
         .fallback = "1",
         .doc = "Of `strength_noise`: the number of an interface depends on this and its index only."},
        {.path = "solver", .type = KeyType::mapping, .doc = "How equilibrium is found."},
        {.path = "solver.tolerance",
         .type = KeyType::number,
         .range = between_zero_and_one,
         .fallback = "1e-5",
         .doc = "Largest residual force, relative to the reference force of contacts and loads."},
        {.path = "solver.balance",
         .type = KeyType::number,
         .range = between_zero_and_one,
         .fallback = "1e-3",
         .doc = "What may be left over on a block of a balanced step, or on blocks that hold together, relative to its "
                "own "
                "force: that of its loads, of a block without any that of its contacts."},
        {.path = "solver.accuracy",
         .type = KeyType::number,
         .range = between_zero_and_one,
         .fallback_note = "steps as the stages say",
         .doc =
             "Of the axial stress up to its peak, relative (of the stresses of the blocks where only loads are "
             "prescribed). "
             "Load steps get the size that keeps their estimated error below it; the `steps` of a stage are then "
             "the size of its first one only, and history.csv has one row per step that was accepted. With "
             "`cracks.update: event` each potential crack fails where its f is 1 to within this accuracy; "
             "`cracks.event_tolerance` then only says which fail together, up to the peak, and the first slip of each "
             "mapped fracture ends a step at its own load; "
             "with another update cracks fail at the ends of the steps, and the accuracy holds for the friction "
             "only. Stages of `strength_reduction` keep their steps. For `integrator: implicit` and `cracks.every: 1` "
             "only."},
        {.path = "solver.detection_every",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "1",
         .doc = "Most load steps between two detections of contacts; in between their points and frames stay. Contacts "
                "are always detected where a block has moved by 5e-3 of its spacing, after a crack, in jumps, where a "
                "step is taken again and at the start of a stage."},
        {.path = "solver.viscosity",
         .type = KeyType::number,
         .range = not_negative,
         .fallback = "5e-3",
         .doc = "Size of the mass-like term, eta H^2/E with the body's height H and modulus E."},
        {.path = "solver.max_iterations",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "12",
         .doc = "Open-close iterations before a solve is given up and the motion of the body is followed."},
        {.path = "solver.max_unbalanced_steps",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "10",
         .doc = "Successive unbalanced steps that end a run."},
        {.path = "solver.max_step_solves",
         .type = KeyType::integer,
         .range = positive_integer,
         .fallback = "20000",
         .doc = "Linear solves that one load step, or one trial of a strength reduction, may take, broken bonds and "
                "motions included; a step that takes more "
                "ends the "
                "run without an equilibrium, at its last balanced state, from which it can be resumed with a larger "
                "number."},
        {.path = "solver.tangent",
         .type = KeyType::choice,
         .choices = {"unsymmetric", "symmetric"},
         .fallback = "unsymmetric",
         .doc =
             "The exact tangent, or its symmetric part (more iterations, cheaper each; near a limit it misses "
             "equilibria that the exact one finds: a wall under `strength_reduction` came to 4.25 in place of 4.58)."},
        {.path = "solver.reuse",
         .type = KeyType::boolean,
         .fallback = "true",
         .doc = "Reuse a factor for many linear solves; `false` factorizes the tangent in each, for comparison."},
        {.path = "solver.repeatable",
         .type = KeyType::boolean,
         .fallback = "false",
         .doc = "Bit-identical runs for any number of threads, also where a run is resumed (but not in the midst of a "
                "strength reduction): a new factor in each load step."},
        {.path = "output", .type = KeyType::mapping, .doc = "What a run writes beside its tables."},
        {.path = "output.fields",
         .type = KeyType::boolean,
         .fallback = "true",
         .doc =
             "Write `fields.pvd` and `fields/*.vtu` for ParaView, and `contacts/*.csv` and `supports/*.csv` with every "
             "force on every block (docs/files.md)."},
        {.path = "output.fields_every",
         .type = KeyType::integer,
         .range = natural,
         .fallback = "0",
         .doc = "Load steps between two states that are kept so. Always kept are the first state, the last one of each "
                "stage, and that of the load step with the largest axial stress at its end; 0: no others for their "
                "number."},
        {.path = "output.fields_at_cracks",
         .type = KeyType::integer,
         .range = natural,
         .fallback = "10",
         .doc = "The most states that are kept so because potential cracks failed in their load step: where there are "
                "more "
                "such load steps, every second, fourth ... of them."},
        {.path = "output.pictures",
         .type = KeyType::boolean,
         .fallback = "true",
         .doc = "Write `curve` and `blocks` as `.png` and `.svg`."},
        {.path = "output.report",
         .type = KeyType::boolean,
         .fallback = "true",
         .doc = "Write `report.html`, one page to be handed on: the answer, the curve, the body at the states that are "
                "kept."},
        {.path = "output.histories",
         .type = KeyType::named,
         .doc =
             "What `histories.csv` follows, by name: a block (`block`, `point`), a mapped fracture (`fracture`) or the "
             "contacts of two blocks (`interface`). One row per accepted load step, the first the initial state, with "
             "the columns `step`, `stage`, `load_factor`; for a block `<name>.displacement_x`, `.displacement_y` (m), "
             "`.rotation` (rad, counter-clockwise), `.stress_xx`, `.stress_yy`, `.stress_xy` (Pa, positive in "
             "compression); for the others, over all their contact points, `.normal_force`, `.shear_force` (N/m), "
             "`.mean_normal_traction`, `.mean_shear_traction` (Pa), `.opening`, `.slip` (m, means weighted with "
             "length). Normal forces and tractions are positive in compression, openings when open. The normal points "
             "from the first to the second block; slip and shear are positive where the second one moves, or is held "
             "back from moving, to the left of it, which stays so if the two are named the other way round. Opening "
             "and slip are total, since the body as cut."},
        {.path = "output.histories.*", .type = KeyType::mapping, .doc = "One of them."},
        {.path = "output.histories.*.block",
         .type = KeyType::text,
         .fallback_note = "the block that has the point in it",
         .doc = "Name of a given block, or of a set of exactly one block."},
        {.path = "output.histories.*.point",
         .type = KeyType::point,
         .measure = Measure::length,
         .fallback_note = "the centroid of the block",
         .doc = "Material point of the block whose displacement is followed, in the body as cut."},
        {.path = "output.histories.*.fracture", .type = KeyType::text, .doc = "Name of a mapped fracture."},
        {.path = "output.histories.*.interface",
         .type = KeyType::texts,
         .least_items = 2,
         .doc = "Names of two blocks, as of `block`."},
        {.path = "output.checkpoint_every",
         .type = KeyType::integer,
         .range = natural,
         .fallback = "0",
         .doc = "Load steps between two states saved; 0: at the end of each stage."},
        {.path = "output.checkpoint_seconds",
         .type = KeyType::number,
         .measure = Measure::time,
         .range = not_negative,
         .fallback = "60",
         .doc =
             "A state is saved at the end of a load step too where the last one is as old by the clock, so that a run "
             "that is killed loses no more; 0: never for that reason. Saving changes no result."},
    };
}

std::vector<KeyRule> all_rules() {
    std::vector<KeyRule> rules{
        {.path = "kluft",
         .type = KeyType::integer,
         .range = {.least = 1.0, .most = 1.0},
         .required = true,
         .doc = "Version of the scene format."},
        {.path = "title", .type = KeyType::text, .fallback_note = "none", .doc = "One line for plots and logs."},
        {.path = "extends",
         .type = KeyType::text,
         .fallback_note = "none",
         .doc = "Another scene, relative to this file, that this one changes."},
    };
    for (const auto& part : {analysis_rules(), material_rules(), interface_rules(), domain_rules(), cut_rules(),
                             block_rules(), loading_rules(), option_rules()})
        rules.insert(rules.end(), part.begin(), part.end());
    return rules;
}

} // namespace

const KeyTable& scene_schema() {
    static const KeyTable keys(all_rules());
    return keys;
}

} // namespace kluft
