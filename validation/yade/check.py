"""Envelope, modulus and curves of intact rock beside bonded disks of YADE, an explicit program, at four lateral pressures."""

import math

import numpy as np

from suite import figures
from suite.case import Table

STRAINS = {"0": 4e-3, "0.2": 12e-3, "0.55": 22e-3, "1.0": 32e-3}  # of the runs, by lateral pressure in MPa: past the peak
COLOURS = {"0": figures.INK, "0.2": figures.FOUND, "0.55": figures.SECOND, "1.0": figures.THIRD}


def envelope(peaks):
    """c (Pa) and phi (degrees) of the least-squares line of sigma_1 on sigma_3; peaks: {sigma_3: sigma_1}."""
    slope, strength = np.polyfit(list(peaks), list(peaks.values()), 1)
    return strength / (2 * math.sqrt(slope)), math.degrees(math.asin((slope - 1) / (slope + 1)))


def modulus(strain, stress):
    """Slope of the curve between 5 and 30 % of its peak."""
    peak = int(np.argmax(stress))
    part = slice(0, peak + 1)
    rise = stress[part] - stress[0]
    chosen = (rise > 0.05 * rise[-1]) & (rise < 0.3 * rise[-1])
    return np.polyfit(strain[part][chosen], stress[part][chosen], 1)[0]


def mean_difference(disks, blocks):
    """Mean difference of the curves up to the smaller peak strain over the disks' peak."""
    end = min(strain[int(np.argmax(stress))] for strain, stress in (disks, blocks))
    grid = np.linspace(0, end, 201)
    return float(np.mean(np.abs(np.interp(grid, *blocks) - np.interp(grid, *disks))) / disks[1].max())


def check(case):
    disks, blocks, shares = {}, {}, {}
    for pressure, strain in STRAINS.items():
        run = case.run(f"p-{pressure}", {"stages.0.pressure.left": f"{pressure} MPa", "stages.0.pressure.right": f"{pressure} MPa",
                                         "stages.1.strain.value": strain}, may_fail=True)
        moved = (run.history["stage"] == 1) & (run.history["balanced"] == 1)
        blocks[pressure] = run.history["axial_strain"][moved], run.history["axial_stress"][moved]
        other = Table(case.directory / f"yade-{pressure}.csv")
        disks[pressure] = other["axial_strain"], other["axial_stress"]
        at_peak = int(np.argmax(other["axial_stress"]))
        counts = [other[key][at_peak] for key in ("cracks_tension", "cracks_shear")]
        at_peak = int(np.argmax(np.where(run.history["balanced"] == 1, run.history["axial_stress"], -np.inf)))
        own = [run.history[key][at_peak] for key in ("cracks_tension", "cracks_shear")]
        shares[pressure] = [part[0] / max(sum(part), 1) for part in (counts, own)]
    lines = [envelope({1e6 * float(p): curve[1].max() for p, curve in curves.items()}) for curves in (disks, blocks)]
    (c, phi), (own_c, own_phi) = lines
    case.expect("cohesion of the envelope", c / 1e6, own_c / 1e6, 0.1, "MPa", digits=4)
    case.expect("friction angle of the envelope", phi, own_phi, 2.0, "deg", absolute=True, digits=4)
    case.expect("modulus at 0.2 MPa", modulus(*disks["0.2"]) / 1e6, modulus(*blocks["0.2"]) / 1e6, 0.1, "MPa", digits=4)
    draw(case, disks, blocks, lines)
    for pressure in STRAINS:
        print_line(pressure, disks[pressure], blocks[pressure], shares[pressure], case)


def print_line(pressure, disks, blocks, shares, case):
    """A line of the README's second table."""
    strains = [100 * strain[int(np.argmax(stress))] for strain, stress in (disks, blocks)]
    peaks = [curve[1].max() / 1e6 for curve in (disks, blocks)]
    moduli = [modulus(*curve) / 1e6 for curve in (disks, blocks)]
    with open(case.output / "curves.md", "a", encoding="utf-8") as file:
        file.write(f"| {pressure} | {peaks[0]:.3f} / {peaks[1]:.3f} | {strains[0]:.2f} / {strains[1]:.2f} | {moduli[0]:.0f} / {moduli[1]:.0f} "
                   f"| {100 * mean_difference(disks, blocks):.1f} | {100 * shares[0]:.0f} / {100 * shares[1]:.0f} |\n")


def draw(case, disks, blocks, lines):
    figure, (left, right) = case.figure(9.4, 3.6, sketch=False, plots=2)
    for pressure, colour in COLOURS.items():
        for (strain, stress), style in ((disks[pressure], "--"), (blocks[pressure], "-")):
            shown = strain <= STRAINS[pressure]
            left.plot(100 * strain[shown], stress[shown] / 1e6, style, color=colour, linewidth=1.0,
                      label=f"{pressure} MPa" if style == "-" else None)
    left.set(xlabel="axial strain (%)", ylabel="axial stress (MPa)", ylim=(0, None))
    left.legend(title="lines: blocks, dashed: disks")
    lateral = np.linspace(0, 1.1, 2)
    for (c, phi), curves, colour, marker, label in ((lines[0], disks, figures.SECOND, "s", "disks (YADE)"),
                                                    (lines[1], blocks, figures.FOUND, "o", "blocks")):
        sine = math.sin(math.radians(phi))
        line = (2 * c / 1e6 * math.cos(math.radians(phi)) + lateral * (1 + sine)) / (1 - sine)
        right.plot(lateral, line, color=colour, linewidth=0.9, linestyle="--" if marker == "s" else "-")
        right.plot([float(p) for p in curves], [curve[1].max() / 1e6 for curve in curves.values()], marker, color=colour,
                   label=f"{label}: {c / 1e6:.3f} MPa, {phi:.1f} deg")
    right.set(xlabel="lateral pressure (MPa)", ylabel="peak axial stress (MPa)")
    right.legend()
    case.save_figure(figure)
