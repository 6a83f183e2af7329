# %% [markdown]
# # A mapped outcrop
# 240 traces of a real outcrop, cut into blocks and pressed from three sides.

# %%
import kluft

scene = kluft.Scene.from_yaml("models/outcrop-kb7.yaml")
scene.check()

# %%
scene.draw()

# %%
scene["stages.0.steps"] = 2
results = scene.run("results/outcrop")
results.fields("last").plot("sigma_1")

# %% [markdown]
# Where joints slip, and how far:

# %%
joints = results.fields("last").interfaces
sliding = joints[joints["state"] == "sliding"]
print(f"{len(sliding)} of {len(joints)} stretches of joint slide, by up to {abs(sliding['slip']).max() * 1e3:.2f} mm")
