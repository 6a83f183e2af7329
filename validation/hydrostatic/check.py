"""Stress, strain, tractions and cracks of bonded hexagons under hydrostatic pressure."""

import math

import numpy as np

from suite import figures

E, NU, D, NORMAL_STIFFNESS = 10e9, 0.25, 0.03, 1e12
SMALL, LARGE = 1e3, 100e6


def strain_of(pressure):
    """Of the net, compression positive: p over 2K of the net (docs/theory.md, eq. 20)."""
    return pressure * ((1 + NU) * (1 - 2 * NU) / E + 1 / (D * NORMAL_STIFFNESS))


def love_weber(blocks, faces):
    """Mean stress sym(sum f (x) x)/A over the pressure of all whole hexagons inside, (n, 3): xx, yy, xy."""
    middles, areas = faces.middles(), blocks.areas()
    whole = areas > 0.999 * areas.max()
    result = []
    for centre, area in zip(blocks.middles()[whole], areas[whole]):
        own = np.flatnonzero(np.linalg.norm(middles - centre, axis=1) < 0.51 * D)
        if len(own) < 6:
            continue
        total = np.zeros((2, 2))
        for face in own:
            start, end = faces.points[faces.cells[face]]
            along = (end - start) / np.linalg.norm(end - start)
            normal = np.array([along[1], -along[0]])
            arm = 0.5 * (start + end) - centre
            side = math.copysign(1.0, normal @ arm)
            force = side * np.linalg.norm(end - start) * (faces["normal_traction"][face] * normal + faces["shear_traction"][face] * along)
            total += np.outer(force, arm)
        total = 0.5 * (total + total.T) / area
        result.append([total[0, 0], total[1, 1], total[0, 1]])
    return np.array(result)


def check(case):
    run = case.run("small")
    blocks, faces = run.blocks(), run.interfaces()
    stress = np.transpose([blocks[f"stress_{name}"] for name in ("xx", "yy", "xy")]) / SMALL
    case.expect_worst("stress of all blocks over p: -1, -1, 0", np.broadcast_to([-1.0, -1.0, 0.0], stress.shape), stress, 1e-6, absolute=True)
    case.expect_worst("tractions over p: -1, 0", np.tile([-1.0, 0.0], (len(faces), 1)),
                      np.transpose([faces["normal_traction"], faces["shear_traction"]]) / SMALL, 1e-6, absolute=True)
    case.expect("strain of the net", strain_of(SMALL) * 1e6, run_strain(blocks) * 1e6, 1e-6, "1e-6")
    from_forces = love_weber(blocks, faces) / SMALL
    case.expect_worst("Love-Weber stress over p: -1, -1, 0", np.broadcast_to([-1.0, -1.0, 0.0], from_forces.shape), from_forces, 1e-6,
                      absolute=True)
    large = case.run("large", {f"stages.0.pressure.{side}": LARGE for side in ("left", "right", "top")} | {"stages.0.steps": 10})
    case.expect_same("cracks under 100 MPa, c 0.16 MPa", 0, int(large.summary["cracks_tension"] + large.summary["cracks_shear"]))
    draw(case, blocks, stress)


def run_strain(blocks):
    """From the displacements of two centres in a column, far apart."""
    row = D * math.sqrt(3) / 2
    low, high = blocks.nearest((0.1275, 2 * row)), blocks.nearest((0.1275, 8 * row))
    motion = blocks.mean_displacements()
    return (motion[low, 1] - motion[high, 1]) / (blocks.middles()[high, 1] - blocks.middles()[low, 1])


def draw(case, blocks, stress):
    figure, (sketch, plot) = case.figure(7.6, 3.2, ratios=[0.9, 1])
    for cell in blocks.cells:
        figures.block(sketch, blocks.points[cell], linewidth=0.6)
    for s in (0.06, 0.15, 0.24):
        figures.arrow(sketch, (s, 0.32), (s, 0.265))
    for s in (0.05, 0.13, 0.21):
        figures.arrow(sketch, (-0.06, s), (-0.005, s))
        figures.arrow(sketch, (0.36, s), (0.305, s))
    figures.smooth_support(sketch, (0, 0), (0.3, 0), 0.015, 10)
    area = blocks.areas() / blocks.areas().max()
    error = np.maximum(np.abs(stress - [-1.0, -1.0, 0.0]).max(axis=1), 1e-16)
    plot.semilogy(area, error, "o", color=figures.FOUND, markersize=3.5)
    plot.set(xlabel="area of the block / area of a hexagon", ylabel="error of its stress / p", ylim=(1e-16, 1e-5))
    plot.axhline(1e-6, color=figures.PALE, linestyle=":", linewidth=0.9)
    case.save_figure(figure)
