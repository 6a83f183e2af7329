"""Compression of bonded disks between platens, for YADE: the other side of scene.yaml. Run by scripts/compare-yade as

    yade -j1 -x -n disks.py LATERAL_PRESSURE FINAL_STRAIN STRAIN_RATE CURVE.csv

Disks of one layer that move in the plane, bonded by the jointed cohesive frictional law; the lowest and uppermost ones are the
platens, the outermost ones of each side carry the lateral pressure. Pressures in Pa, positive in compression; rate in 1/s."""

import csv
import math
import sys
import time

import numpy as np
from scipy.spatial import cKDTree
from yade import *  # noqa: F403

WIDTH, HEIGHT, N_DISKS = 0.38, 1.00, 500
FILLED = 0.85  # part of the area that disks cover
BOND_RANGE = 1.3  # disks nearer than this times the sum of their radii are bonded
RECORDS = 200
ROCK = dict(young=300e6, poisson=0.4, frictionAngle=math.radians(35), density=2600, tensileStrength=0.1e6, cohesion=0.3e6, type=1)


def packing(seed=1):
    """Centres and radii of disks that hardly overlap: placed at random, then pushed apart."""
    random = np.random.default_rng(seed)
    radius = random.uniform(0.75, 1.25, N_DISKS)
    radius *= math.sqrt(FILLED * WIDTH * HEIGHT / (math.pi * np.sum(radius**2)))
    centre = random.uniform((0, 0), (WIDTH, HEIGHT), (N_DISKS, 2))
    box = np.array([WIDTH, HEIGHT])
    for _ in range(4000):
        a, b = cKDTree(centre).query_pairs(2 * radius.max(), output_type="ndarray").T
        apart = centre[b] - centre[a]
        distance = np.linalg.norm(apart, axis=1) + 1e-15
        overlap = np.maximum(radius[a] + radius[b] - distance, 0.0)
        push = 0.4 * (overlap / distance)[:, None] * apart
        np.add.at(centre, a, -push)
        np.add.at(centre, b, push)
        centre = np.clip(centre, radius[:, None], box - radius[:, None])
        if overlap.max() < 0.05 * radius.mean():
            break
    return centre, radius


def load_sides(bodies, centre, radius, pressure):
    """A force on the outermost disk of each strip of the two sides."""
    strips = int(HEIGHT / (2.2 * radius.mean()))
    strip = np.minimum((centre[:, 1] / HEIGHT * strips).astype(int), strips - 1)
    for k in range(strips):
        inside = [i for i in bodies if strip[i] == k]
        if not inside:
            continue
        force = pressure * HEIGHT / strips * 2 * radius.mean()
        O.forces.setPermF(min(inside, key=lambda i: centre[i, 0] - radius[i]), (force, 0, 0))
        O.forces.setPermF(max(inside, key=lambda i: centre[i, 0] + radius[i]), (-force, 0, 0))


def main(pressure, final_strain, strain_rate, path):
    centre, radius = packing()
    material = O.materials.append(JCFpmMat(**ROCK))
    for (x, y), r in zip(centre, radius):
        O.bodies.append(sphere((x, y, 0), r, material=material))
        O.bodies[-1].state.blockedDOFs = "zXY"
    lowest = [i for i in range(N_DISKS) if centre[i, 1] < 1.6 * radius.mean()]
    uppermost = [i for i in range(N_DISKS) if centre[i, 1] > HEIGHT - 1.6 * radius.mean()]
    for i in lowest + uppermost:
        O.bodies[i].state.blockedDOFs = "xyzXYZ"
    load_sides(sorted(set(range(N_DISKS)) - set(lowest + uppermost)), centre, radius, pressure)
    law = Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM()
    near, boxes = Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=BOND_RANGE), Bo1_Sphere_Aabb(aabbEnlargeFactor=BOND_RANGE)
    O.engines = [ForceResetter(), InsertionSortCollider([boxes], verletDist=0.1 * radius.mean()),
                 InteractionLoop([near], [Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)], [law]),
                 NewtonIntegrator(damping=0.4)]
    O.dt = 0.5 * PWaveTimeStep()
    O.step()  # bonds are made in the first step, at the larger range
    near.interactionDetectionFactor = boxes.aabbEnlargeFactor = 1.0
    O.run(2000, True)

    length = centre[uppermost, 1].mean() - centre[lowest, 1].mean()
    speed = strain_rate * length / 2
    for i in lowest:
        O.bodies[i].state.vel = (0, speed, 0)
    for i in uppermost:
        O.bodies[i].state.vel = (0, -speed, 0)
    start = O.time
    between = max(1, round(final_strain / strain_rate / O.dt / RECORDS))
    cpu = time.process_time()
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["axial_strain", "axial_stress", "cracks_tension", "cracks_shear", "processor_s"])
        strain = 0.0
        while strain < final_strain:
            O.run(between, True)
            strain = strain_rate * (O.time - start)
            force = 0.5 * (sum(O.forces.f(i)[1] for i in uppermost) - sum(O.forces.f(i)[1] for i in lowest))
            stress = force / (WIDTH * 2 * radius.mean())
            table.writerow([f"{strain:.6g}", f"{stress:.6g}", law.nbTensCracks, law.nbShearCracks, f"{time.process_time() - cpu:.4g}"])


main(*map(float, sys.argv[1:4]), sys.argv[4])
