"""Small bodies of which the answer is known, as scenes (YAML is a superset of JSON), with the values they must give."""

import math

CLOSE = {"tolerance": 1e-10, "balance": 1e-9}
QUIET = {"pictures": False, "fields": False}
FIELDS = {"pictures": False, "fields": True}
SHARP = {"contact_rounding": 0, "friction_rounding": 0}
ROW = math.sqrt(0.75)  # between rows of hexagons, in spacings


def fracture(normal, shear, **strength):
    return {"kind": "fracture", "normal_stiffness": normal, "shear_stiffness": shear, **SHARP, **strength}


def bond(normal, shear, **strength):
    return {"kind": "potential_crack", "normal_stiffness": normal, "shear_stiffness": shear, "fails_to": "joint", **strength}


def rock(modulus, poisson=0.25, **more):
    return {"rock": {"youngs_modulus": modulus, "poissons_ratio": poisson, **more}}


def strong(modulus):
    return {"cohesion": min(1e15, 1e3 * modulus), "friction_angle": 30, "tensile_strength": min(1e15, 1e3 * modulus)}


def body(interfaces, materials, geometry, stages, boundaries=None, plane="stress", solver=None, output=None, **more):
    scene = {"kluft": 1, "analysis": {"plane": plane, **more.pop("analysis", {})}, "materials": materials,
             "interfaces": interfaces, "geometry": geometry,
             "boundaries": {"bottom": {"support": "pinned"}} if boundaries is None else boundaries, "stages": stages,
             "solver": solver or CLOSE, "output": output or QUIET, **more}
    return {key: value for key, value in scene.items() if value != {}}


def across(height, width):
    """The trace of a joint across a column."""
    return [[-0.1 * width, height], [1.1 * width, height]]


# ---- column with joints across it --------------------------------------------------------------------------------


def column(modulus=1e10, poisson=0.25, normal=1e10, shear=5e9, height=4.0, width=1.0, strain=1e-8, steps=1, joints=(0.125, 0.375,
           0.625, 0.875), friction=30, **more):
    fractures = [{"trace": across(height * joint, width)} for joint in joints]
    return body({"joint": fracture(normal, shear, friction_angle=friction)}, rock(modulus, poisson),
                {"domain": {"rectangle": {"width": width, "height": height}}, "fractures": fractures},
                [{"name": "platen", "displacement": {"boundary": "top", "value": strain * height, "glued": strain < 0 and not joints},
                  "steps": steps}], **more)


def column_modulus(modulus=1e10, normal=1e10, height=4.0, n_joints=4):
    return 1 / (1 / modulus + n_joints / (normal * height))


# ---- net of hexagons ----------------------------------------------------------------------------------------------


def net(columns, rows, spacing):
    """Between platens on rows of centres, which are mirror lines of the net."""
    return {"domain": {"rectangle": {"width": columns * spacing, "height": rows * ROW * spacing}},
            "tessellation": {"hexagons": {"spacing": spacing, "offset": [0.25 * spacing, 0]}, "interface": "bond"}}


def moduli(modulus, poisson, normal, shear, spacing, plane="stress"):
    """2K and 2G of the net (docs/theory.md, eq. 20)."""
    bulk = modulus / ((1 + poisson) * (1 - 2 * poisson)) if plane == "strain" else modulus / (1 - poisson)
    rigidity = modulus / (1 + poisson)
    return 1 / (1 / bulk + 1 / (spacing * normal)), 1 / (1 / rigidity + 2 / (spacing * (normal + shear)))


def pressed_net(modulus=1e10, poisson=0.25, normal=1e12, shear=5e11, spacing=0.03, pressure=1e3, rows=10, columns=10, kind="bond",
                friction=30, **more):
    """Under the same pressure on all sides; every block has the stress -p, the strain of the net is p/2K."""
    interfaces = {"bond": bond(normal, shear), "joint": fracture(normal, shear, friction_angle=friction)}
    geometry = net(columns, rows, spacing)
    geometry["tessellation"]["interface"] = kind
    more.setdefault("output", FIELDS)
    more.setdefault("plane", "strain")
    return body(interfaces, rock(modulus, poisson, **strong(modulus)), geometry,
                [{"name": "pressure", "pressure": {side: pressure for side in ("left", "right", "top")}}], **more)


def strip(modulus=1e10, poisson=0.25, normal=1e12, shear=5e11, spacing=0.03, strain=1e-7, columns=40, **more):
    """A wide strip of hexagons pressed between smooth platens, sides free: E and nu of the net in its middle."""
    interfaces = {"bond": bond(normal, shear), "joint": fracture(normal, shear, friction_angle=30)}
    return body(interfaces, rock(modulus, poisson, **strong(modulus)), net(columns, 6, spacing),
                [{"name": "platen", "strain": {"boundary": "top", "value": strain}}], output=FIELDS,
                solver=CLOSE | {"viscosity": 0}, **more)


# ---- strength -----------------------------------------------------------------------------------------------------


def radians(angle):
    return math.radians(angle)


def weak_plane(friction=30.0, cohesion=1e5, lateral=2e5, stiffness=1.0, ratio=1.0, modulus=None, steps=40, **more):
    """One plane across a specimen under lateral pressure (Jaeger 1960), pressed to twice the strain at slip. Its normal
    stiffness is `stiffness` E over the width. E is so large that the slip does not change the loaded width."""
    slope = radians(45 + friction / 2)
    strength = weak_plane_strength(friction, cohesion, lateral)
    if modulus is None:
        modulus = weak_plane_modulus(strength, stiffness * min(1.0, ratio))
    normal, shear = stiffness * modulus, stiffness * ratio * modulus
    rise = math.tan(slope)
    height = rise + 1.0
    closure = strength * (height / modulus + math.cos(slope) ** 2 / normal + math.sin(slope) ** 2 / shear)
    trace = [[-0.05, 0.5 - 0.05 * rise], [1.05, 0.5 + 1.05 * rise]]
    return body({"plane": fracture(normal, shear, friction_angle=friction, cohesion=cohesion)}, rock(modulus),
                {"domain": {"rectangle": {"width": 1, "height": height}}, "fractures": [{"trace": trace}]},
                [{"name": "pressure", "pressure": {side: lateral for side in ("left", "right", "top")}},
                 {"name": "platen", "displacement": {"boundary": "top", "value": 2 * (closure + lateral / normal)}, "steps": steps}],
                boundaries={"bottom": {"support": "smooth"}}, plane="strain",
                **({"solver": {"tolerance": 1e-10, "balance": 1e-7}} | more))


def weak_plane_modulus(strength, softest=1.0):
    """So that strains and the slip are about 1e-7, as far as the largest modulus of a scene allows."""
    return min(1e15, 1e7 * max(strength, 1e-3) / min(1.0, softest))


def weak_plane_strength(friction, cohesion, lateral, slope=None):
    slope = 45 + friction / 2 if slope is None else slope
    tangent = math.tan(radians(friction))
    return 2 * (cohesion + lateral * tangent) / ((1 - tangent / math.tan(radians(slope))) * math.sin(radians(2 * slope)))


def pushed_block(friction, share, density=2500.0, gravity=10.0, modulus=1e12, normal=1e12, ratio=0.5, cohesion=0.0, length=1.0, **more):
    """A block on a fixed one, pushed along its base with `share` of the force W tan(phi) + c L that it can take."""
    weight = density * gravity * length**2
    limit = weight * math.tan(radians(friction)) + cohesion * length
    push = share * limit if limit > 0 else (share - 1 + 1e-3 if share > 1 else 0.0) * weight
    blocks = [{"name": "base", "polygon": [[-length, -length], [2 * length, -length], [2 * length, 0], [-length, 0]], "support": "fixed"},
              {"name": "block", "polygon": [[0, 0], [length, 0], [length, length], [0, length]]}]
    # The push is shared by both lower corners, so that it neither turns nor stretches the block.
    forces = {side: {"block": "block", "point": [x * length, 0], "force": [0.5 * push, 0]} for side, x in (("left", 0), ("right", 1))}
    return body({"joint": fracture(normal, ratio * normal, friction_angle=friction, cohesion=cohesion)},
                rock(modulus, 0, density=density), {"blocks": blocks},
                [{"name": "weight"}, {"name": "push", "forces": forces, "steps": 4}], boundaries={},
                analysis={"gravity": [0, -gravity]}, **({"solver": {"tolerance": 1e-10, "balance": 1e-7, "viscosity": 1e-4}} | more))


def bar(cohesion, friction, tension, pull, modulus=1e9, normal=1e10, failure=None, steps=4, criterion="principal_stress", **more):
    """A bar with one potential crack across it, pulled or pressed to twice its strength, or to 1e-3 if that is less strain."""
    strength = bar_strength(cohesion, friction, tension, pull) if failure is None else failure
    stiffness = column_modulus(modulus, normal, 2.0, 1)
    strain = min(1e-3, max(2 * strength / stiffness, 1e-9))
    interfaces = {"joint": fracture(normal, 0.5 * normal, friction_angle=0),
                  "bond": bond(normal, 0.5 * normal, cohesion=cohesion, friction_angle=friction, tensile_strength=tension)}
    return body(interfaces, rock(modulus, 0), {"domain": {"rectangle": {"width": 1, "height": 2}},
                                               "fractures": [{"trace": across(1.0, 1.0), "interface": "bond"}]},
                [{"name": "platen", "strain": {"boundary": "top", "value": -strain if pull else strain, "glued": pull}, "steps": steps}],
                cracks={"criterion": criterion, "event_tolerance": 1e-7}, **more)


def bar_strength(cohesion, friction, tension, pull):
    phi = radians(friction)
    if pull:
        return min(tension, cohesion / math.tan(phi)) if friction > 0 else tension
    return 2 * cohesion * math.cos(phi) / (1 - math.sin(phi))


# ---- sizes and shapes ---------------------------------------------------------------------------------------------


def pile(size, large=1.0, density=2500.0, gravity=10.0, modulus=1e10, normal=1e10):
    """A small square block on a large one on a fixed one, under their weights."""
    x = 0.5 * large - 0.5 * size
    blocks = [{"name": "base", "polygon": [[-large, -large], [2 * large, -large], [2 * large, 0], [-large, 0]], "support": "fixed"},
              {"name": "large", "polygon": [[0, 0], [large, 0], [large, large], [0, large]]},
              {"name": "small", "polygon": [[x, large], [x + size, large], [x + size, large + size], [x, large + size]]}]
    return body({"joint": fracture(normal, 0.5 * normal, friction_angle=30)}, rock(modulus, 0, density=density), {"blocks": blocks},
                [{"name": "weight"}], boundaries={}, analysis={"gravity": [0, -gravity]},
                output=QUIET | {"histories": {"upper": {"interface": ["large", "small"]}, "lower": {"interface": ["base", "large"]}}})


def slab(thickness, aspect=1.0, modulus=1e10, normal=1e10):
    """A column with a thin slab between two joints, given as blocks."""
    width, half = aspect, 0.5
    levels = [0.0, half, half + thickness, 1.0 + thickness]
    blocks = [{"name": f"b{i}", "polygon": [[0, low], [width, low], [width, high], [0, high]]}
              for i, (low, high) in enumerate(zip(levels, levels[1:]))]
    return body({"joint": fracture(normal, 0.5 * normal, friction_angle=30)}, rock(modulus, 0), {"blocks": blocks},
                [{"name": "platen", "displacement": {"boundary": "top", "value": 1e-6 * levels[-1]}}])


def wedge(angle, pressure, modulus=1e10, normal=1e10):
    """Two joints that cross at a small angle leave two needles, which are thick beside their closure. Hydrostatic pressure is hydrostatic stress in all blocks."""
    rise = 0.5 * math.tan(angle)
    fractures = [{"trace": across(1.0, 1.0)}, {"trace": [[-0.1, 1.0 - 1.2 * rise], [1.1, 1.0 + 1.2 * rise]]}]
    return body({"joint": fracture(normal, 0.5 * normal, friction_angle=30)}, rock(modulus, 0.25),
                {"domain": {"rectangle": {"width": 1, "height": 2}}, "fractures": fractures},
                [{"name": "pressure", "pressure": {side: pressure for side in ("left", "right", "top")}}], output=FIELDS)


def sliver_net(shift, pressure=1e4, modulus=1e10, normal=1e12):
    """Hexagons cut by a joint that passes beside their edges at a small distance."""
    geometry = net(6, 6, 0.05)
    x = 0.25 * 0.05 + 2.5 * 0.05 + shift * 0.05
    geometry["fractures"] = [{"trace": [[x, -0.1], [x, 1.0]], "interface": "joint"}]
    interfaces = {"bond": bond(normal, 0.5 * normal), "joint": fracture(normal, 0.5 * normal, friction_angle=30)}
    return body(interfaces, rock(modulus, 0.25, **strong(modulus)), geometry,
                [{"name": "pressure", "pressure": {side: pressure for side in ("left", "right", "top")}}], output=FIELDS)


# ---- the triaxial model -------------------------------------------------------------------------------------------

WIDTH, HEIGHT, SPACING = 0.38, 1.0, 0.05
OFFSET = (0.0293491, 0.0659071)
TRACES = [[[0.05334591186012744, -0.01], [0.32665408813987257, 1.01]],
          [[0.14980862113533158, 0.35000046630765816], [-0.01, 0.2754804824330622]],
          [[0.2382298546376021, 0.6799996360297658], [0.39, 0.7352394513919334]]]
MODULUS, STRENGTH, NORMAL, SHEAR, ROUNDING, LATERAL = 1500e6, 0.315e6, 200e6, 100e6, 0.004e6, 0.2e6
TIGHT = {"tolerance": 1e-11, "balance": 1e-10}


def triaxial(length=1.0, stress=1.0, shift=(0.0, 0.0), strain=0.006, steps=6, exact=False, update="all", solver=None):
    """models/triaxial/case-3-all.yaml, in units of 1/length m and 1/stress Pa, elsewhere on the map. `exact`: all coordinates
    of the body are multiples of 1/1024 m, so that they stay what they are when they are shifted."""
    width = 0.375 if exact else WIDTH
    grid = 1024.0

    def place(point):
        x, y = (round(value * grid) / grid for value in point) if exact else point
        return [x * length + shift[0], y * length + shift[1]]

    joint = {"kind": "fracture", "normal_stiffness_times_spacing": NORMAL * stress, "shear_stiffness_times_spacing": SHEAR * stress,
             "friction_angle": 27, "cohesion": 0, "contact_rounding": ROUNDING * stress, "friction_rounding": 0.05}
    rock_bond = {"kind": "potential_crack", "normal_stiffness_times_spacing": NORMAL * stress,
                 "shear_stiffness_times_spacing": SHEAR * stress, "fails_to": "joint"}
    return {"kluft": 1, "analysis": {"plane": "strain"},
            "materials": {"sandstone": {"youngs_modulus": MODULUS * stress, "poissons_ratio": 0.25, "cohesion": STRENGTH * stress,
                                        "friction_angle": 45, "tensile_strength": STRENGTH * stress}},
            "interfaces": {"joint": joint, "rock_bond": rock_bond},
            "geometry": {"domain": {"rectangle": {"width": width * length, "height": HEIGHT * length, "origin": list(shift)}},
                         "fractures": [{"trace": [place(point) for point in trace], "interface": "joint"} for trace in TRACES],
                         "tessellation": {"hexagons": {"spacing": SPACING * length, "rotation": 20,
                                                       "offset": [value * length for value in OFFSET]}, "interface": "rock_bond"}},
            "boundaries": {"bottom": {"support": "pinned"}},
            "stages": [{"name": "pressure", "pressure": {side: LATERAL * stress for side in ("left", "right", "top")}, "steps": 4},
                       {"name": "platen", "strain": {"boundary": "top", "value": strain}, "platens": "smooth", "steps": steps}],
            "cracks": {"update": update}, "solver": solver or TIGHT, "output": QUIET}


# ---- held badly or not at all -------------------------------------------------------------------------------------


def square(name, x, y, size=1.0, **more):
    return {"name": name, "polygon": [[x, y], [x + size, y], [x + size, y + size], [x, y + size]], **more}


def given(blocks, stages, friction=30, boundaries=None, gravity=None, density=2500.0, **more):
    analysis = {"analysis": {"gravity": gravity}} if gravity else {}
    return body({"joint": fracture(1e10, 5e9, friction_angle=friction)}, rock(1e10, 0, density=density), {"blocks": blocks}, stages,
                boundaries=boundaries or {}, **analysis, **more)
