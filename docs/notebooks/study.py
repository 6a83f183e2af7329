# %% [markdown]
# # A study
# Two cohesions, two copies each with other random places of the net, two cases at a time.

# %%
import kluft

scene = kluft.Scene.from_yaml("models/quickstart.yaml")
sweep = scene.sweep({"materials.sandstone.cohesion": ["4 MPa", "6 MPa"]}, "results/cohesion", replicas=2, jobs=2)
sweep.table[["materials.sandstone.cohesion", "replica", "peak_stress"]]

# %%
ax = None
for case in sweep:
    ax = case.plot(ax=ax, label=case.directory.name[:40])
