# %% [markdown]
# # Three triaxial tests
# The strength of a specimen under three lateral pressures, and the line through the peaks.

# %%
import kluft
import numpy as np

scene = kluft.Scene.from_yaml("models/quickstart.yaml")
tests = {}
for pressure in (0.0, 1e6, 3e6):
    for side in ("left", "right", "top"):
        scene[f"stages.0.pressure.{side}"] = pressure
    tests[pressure] = scene.run(f"results/triaxial-{pressure / 1e6:g}")
ax = None
for pressure, results in tests.items():
    ax = results.plot(ax=ax, label=f"{pressure / 1e6:g} MPa")

# %% [markdown]
# Mohr-Coulomb's line $\sigma_1 = N \sigma_3 + q$ has $N = (1 + \sin\varphi) / (1 - \sin\varphi)$ and $q = 2 c \sqrt N$.

# %%
lateral = np.array(list(tests))
axial = np.array([results.summary["peak_stress"] for results in tests.values()])
n, q = np.polyfit(lateral, axial, 1)
friction = np.degrees(np.arcsin((n - 1) / (n + 1)))
print(f"friction angle {friction:.0f} degrees, cohesion {q / (2 * np.sqrt(n)) / 1e6:.1f} MPa")
