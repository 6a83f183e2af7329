# %% [markdown]
# # Ten lines
# Read a scene, change a value, run it, and look.

# %%
import kluft

scene = kluft.Scene.from_yaml("models/quickstart.yaml")
scene["materials.sandstone.cohesion"] = "8 MPa"
results = scene.run("results/harder")
print(f"{results.summary['peak_stress'] / 1e6:.1f} MPa")
results.plot()

# %%
results.fields("peak").plot("sigma_1", scale=20)
