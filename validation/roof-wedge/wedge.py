"""The scenes of the roof wedge and their closed forms."""

import math

HEIGHT, TOP, ALPHA = 4.0, 1.5, math.radians(20)
BASE = TOP + HEIGHT * math.tan(ALPHA)
WEIGHT = 27e3 * (TOP + BASE) * HEIGHT  # N/m
FACE = HEIGHT / math.cos(ALPHA)
FORCE = 0.3e6 * HEIGHT  # N/m, horizontal


def capacity(factor, friction, cohesion=0.0, force=None):
    """Largest weight that the two faces carry: N cos a + S sin a = H, S = N tan(phi)/F + c L/F."""
    force = FORCE if force is None else force
    mu, c = math.tan(math.radians(friction)) / factor, cohesion / factor
    normal = (force - c * FACE * math.sin(ALPHA)) / (math.cos(ALPHA) + mu * math.sin(ALPHA))
    return 2 * (normal * (mu * math.cos(ALPHA) - math.sin(ALPHA)) + c * FACE * math.cos(ALPHA))


def safety(friction, cohesion=0.0, force=None, weight=None):
    weight = WEIGHT if weight is None else weight
    low, high = 1e-3, 1e3
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if capacity(middle, friction, cohesion, force) > weight else (low, middle)
    return low


def turned(points, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [[c * x - s * y, s * x + c * y] for x, y in points]


def abutment(ratio):
    """Corners of the right abutment, counter-clockwise from the wedge's lower corner: floor 0, push 1, roof 2."""
    size = HEIGHT * ratio
    if ratio <= 1:
        return [[BASE, 0], [TOP + size, 0], [TOP + size, HEIGHT], [TOP, HEIGHT]]
    return [[BASE, 0], [TOP + size, 0], [TOP + size, size], [TOP + 3, size], [TOP + 3, HEIGHT + 2], [TOP, HEIGHT]]


def overrides(ratio=1, turn=0.0, neighbour=0, both=False, point=False, force=None, g=10.0):
    """ratio: size of the abutments over that of the wedge; neighbour: the same of a free block on a fixed one beside them;
    both: two pushed abutments instead of a fixed one; point: a dead force instead of pressure."""
    force = FORCE if force is None else force
    right = abutment(ratio)
    left = [[-x, y] for x, y in right]
    wedge = [[-BASE, 0], [BASE, 0], [TOP, HEIGHT], [-TOP, HEIGHT]]
    blocks = [{"name": "wedge", "polygon": turned(wedge, turn)},
              {"name": "left", "polygon": turned(left, turn)},
              {"name": "right", "polygon": turned(right, turn)}]
    boundaries = {"floor": {"block": "right", "sides": [0], "support": "smooth"},
                  "roof": {"block": "right", "sides": [2], "support": "smooth"},
                  "push": {"block": "right", "sides": [1]}}
    side = HEIGHT * max(ratio, 1)
    pressure = {"push": force / side}
    if both:
        boundaries |= {"floor2": {"block": "left", "sides": [0], "support": "smooth"},
                       "roof2": {"block": "left", "sides": [2], "support": "smooth"},
                       "push2": {"block": "left", "sides": [1]}}
        pressure["push2"] = force / side
    else:
        blocks[1]["support"] = "fixed"
    if neighbour:
        size, x = HEIGHT * neighbour, TOP + 2 * side + 2
        blocks += [{"name": "base", "polygon": turned([[x, -HEIGHT], [x + size, -HEIGHT], [x + size, 0], [x, 0]], turn), "support": "fixed"},
                   {"name": "neighbour", "polygon": turned([[x, 0], [x + size, 0], [x + size, size], [x, size]], turn)}]
    gravity = turned([[0, -g]], turn)[0]
    stage = {"name": "push and weight", "gravity": gravity}
    if point:
        stage["forces"] = {"push": {"block": "right", "point": turned([[TOP + side - 1e-9 * side, side / 2]], turn)[0], "force": turned([[-force, 0]], turn)[0]}}
    else:
        stage["pressure"] = pressure
    return {"geometry.blocks": blocks, "boundaries": boundaries, "analysis.gravity": gravity, "stages": [stage]}


def bray_weight():
    """Of a wedge that is pointed, h^2 tan(alpha) gamma."""
    return 27e3 * HEIGHT**2 * math.tan(ALPHA)


def bray_density():
    """With which the blunt wedge of bray.yaml has that weight."""
    blunt = 0.2 + 0.5 * HEIGHT * math.tan(ALPHA)
    return bray_weight() / (10 * 2 * blunt * HEIGHT)


def bray(ratio, force=0.1e6 * HEIGHT):
    """Factor with which P_l of Bray (1977) is the weight; ratio is k_n/k_s."""
    low, high = 0.5, 2.2
    for _ in range(100):
        factor = 0.5 * (low + high)
        phi = math.atan(math.tan(math.radians(40)) / factor)
        limit = (2 * force * (math.cos(ALPHA)**2 + ratio * math.sin(ALPHA)**2) * math.sin(phi - ALPHA)
                 / (math.cos(ALPHA) * math.cos(phi) + ratio * math.sin(ALPHA) * math.sin(phi)))
        low, high = (factor, high) if limit > bray_weight() else (low, factor)
    return low
