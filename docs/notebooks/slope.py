# %% [markdown]
# # Factor of safety of a slope
# The scene is that of the tutorial on slopes, made in Python.

# %%
import kluft
import numpy as np

scene = kluft.Scene({
    "kluft": 1,
    "title": "Slope with two joints",
    "analysis": {"gravity": 9.81},
    "materials": {"rock": {"density": 2600, "youngs_modulus": 20e9, "poissons_ratio": 0.25}},
    "interfaces": {"joint": {"kind": "fracture", "normal_stiffness": 10e9, "shear_stiffness": 5e9,
                             "friction_angle": 35, "cohesion": 40e3}},
    "geometry": {"domain": {"polygon": [[0, 0], [40, 0], [40, 30], [25, 30], [10, 10], [0, 10]]}},
    "boundaries": {"bottom": {"support": "fixed"}},
    "stages": [{"name": "weight"}, {"name": "strength", "strength_reduction": {"from": 0.5, "to": 4}}],
})
scene.add_traces([[(9, 9.5), (33, 31)], [(30, 26), (29, 31)]], interface="joint")
results = scene.run("results/slope")
print(f"factor of safety {results.summary['factor_of_safety']:.3f}")

# %%
results.fields("last").plot("displacement", scale=200)

# %% [markdown]
# How it depends on the cohesion of the joints:

# %%
for cohesion in (0, 20e3, 40e3):
    scene["interfaces.joint.cohesion"] = cohesion
    factor = scene.run(f"results/slope-{cohesion:g}").summary["factor_of_safety"]
    print(f"{cohesion / 1e3:3.0f} kPa: {factor:.3f}")
