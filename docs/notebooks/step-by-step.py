# %% [markdown]
# # Step by step
# A run can be looked at between its load steps, and ended by what is seen.

# %%
import kluft

simulation = kluft.Simulation(kluft.Scene.from_yaml("models/quickstart.yaml"))
for row in simulation:
    if row["cracks_tension"] + row["cracks_shear"] > 5:
        break
print(f"load step {simulation.history[-1]['step']}: {abs(simulation.displacement).max() * 1e3:.2f} mm")
simulation.fields().plot("displacement", scale=100)
