# %% [markdown]
# # A plate that flies, vibrates and is calmed
#
# This page is a notebook: each `# %%` begins a cell (VS Code, Spyder and jupytext read it so). A test runs it.
# Lengths are in mm, masses in Mg (tonnes), times in s, so forces are in N.

# %%
import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import flexframe

project = Path(__file__).resolve().parents[2]
figures = Path(os.environ.get("FLEXFRAME_FIGURES", "."))

# %% [markdown]
# ## A scene
#
# A scene says everything about a run. It is a file, or a dict with the same sections and keys (docs/reference/scene.md). Paths in a
# dict are relative to `base`. This one is a plate of aluminium, 1000 x 50 x 10 mm, free in space. It turns slowly, and its
# first modes vibrate.

# %%
scene = flexframe.Scene(
    {
        "title": "Free plate",
        "units": {"length": "mm", "mass": "Mg", "time": "s"},
        "body": {
            "mesh": "meshes/plate.msh",
            "material": {"young_modulus": 70000.0, "poisson_ratio": 0.33, "density": 2.7e-9},
        },
        "modes": {"flexible": 8},
        "effects": {"large_deflection": False},
        "initial": {"angular_velocity": [0.0, 2.0, 0.0], "modal_velocity": [12.0, 12.0]},
        "time": {"end": 0.5, "step": 5e-5},
        "output": {"interval": 5e-4, "points": {"tip": [-500.0, 0.0, 0.0], "middle": [0.0, 0.0, 0.0]}},
    },
    base=project,
    name="plate",
)

# %% [markdown]
# ## Its body
#
# `Body` reads the mesh, finds the modes and reduces the body. Its arrays are memory of the body itself: nothing is copied, and
# nothing can be written.

# %%
body = flexframe.Body(scene)
print(f"{len(body.positions)} nodes, {1e3 * body.mass:.3f} kg")
print("natural frequencies in Hz:", np.round(body.frequencies, 2))

# %%
x, y, z = body.positions.T
edge = np.flatnonzero((y == y.min()) & (z == z.min()))
edge = edge[np.argsort(x[edge])]

fig, axes = plt.subplots(figsize=(7, 4), layout="constrained")
bending = [k for k in range(8) if np.abs(body.shapes[k, edge, 2]).max() > 2 * np.abs(body.shapes[k, edge, 1]).max()]
for k in bending[:4]:
    shape = body.shapes[k, edge, 2]
    axes.plot(x[edge], shape / np.abs(shape).max(), label=f"mode {k + 1}: {body.frequencies[k]:.1f} Hz")
axes.set(xlabel="x in mm", ylabel="displacement along z, largest 1", title="Mode shapes along an edge of the plate")
axes.legend(loc="upper center", ncols=2)
axes.set_ylim(-1.1, 1.6)
axes.grid(alpha=0.3)
fig.savefig(figures / "mode_shapes.png", dpi=120)

# %% [markdown]
# ## A run
#
# `run` goes to the end and gives arrays by the names of the results file (docs/reference/results.md). `columns` knows the unit and the
# axes of each. (`flexframe.run(scene, folder)` writes the file, too.)

# %%
free = flexframe.Simulation(body).run()
column = free.columns["points/elastic_displacement_body"]
print(free)
print(f"{column.path} in {column.unit}, {column.frame} axes: {column.description}")

tip = free["points/tip/elastic_displacement_body"][:, 2]
fig, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
axes.plot(free["time"], tip, lw=1)
axes.set(xlabel="time in s", ylabel=f"along z in {column.unit}", title="Elastic displacement of the tip, body axes")
axes.grid(alpha=0.3)
fig.savefig(figures / "tip.png", dpi=120)

# %% [markdown]
# The spectrum of the tip has its peaks at the natural frequencies that vibrate.

# %%
spacing = free["time"][1] - free["time"][0]
window = np.hanning(len(tip))
spectrum = np.abs(np.fft.rfft(tip * window)) / window.sum() * 2
frequency = np.fft.rfftfreq(len(tip), spacing)

fig, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
axes.semilogy(frequency, spectrum)
for k in (0, 1):
    axes.axvline(body.frequencies[k], color=f"C{k + 1}", ls=":", label=f"mode {k + 1}: {body.frequencies[k]:.1f} Hz")
axes.set(xlim=(0, 400), ylim=(1e-6, None), xlabel="frequency in Hz", ylabel="amplitude in mm", title="Spectrum of the tip")
axes.legend()
axes.grid(alpha=0.3)
fig.savefig(figures / "spectrum.png", dpi=120)

# %% [markdown]
# ## A controller
#
# A `Force` is at a point of the scene; its law is any function of the motion that gives three components. This one damps
# the plate from the velocity of its tip, seen from the middle. Its work is accounted for: kinetic + strain energy - work is
# what it was.


# %%
def damper(motion):
    return -0.003 * (motion.velocity() - motion.velocity("middle"))


damped = flexframe.Simulation(body, [flexframe.Force("tip", damper)]).run()
balance = damped["energy/balance"]
energy_left = damped["energy/strain"][-200:].max() / free["energy/strain"][-200:].max()
print(f"strain energy left: {energy_left:.3f} of that of the free plate")
print(f"balance of energy closed to {np.abs(balance / balance[0] - 1).max():.1e}")

fig, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
axes.plot(free["time"], free["energy/strain"], lw=1, label="free")
axes.plot(damped["time"], damped["energy/strain"], lw=1, label="damped by the controller")
axes.set(xlabel="time in s", ylabel="strain energy in mJ", ylim=(None, 180), title="A controller written in Python")
axes.legend(loc="upper right", ncols=2)
axes.grid(alpha=0.3)
fig.savefig(figures / "controller.png", dpi=120)

# %% [markdown]
# ## Step by step: an event
#
# A simulation may be taken from row to row, to a time, or to an event: where a function of the motion passes through zero.
# There the state may be changed. A rigid body falls by 1.5 m, and is thrown back.

# %%
falling = flexframe.Scene(
    {
        "title": "Falling body",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "body": {"rigid": {"mass": 2.0, "center_of_mass": [0.0] * 3, "inertia": np.diag([0.2, 0.3, 0.4])}},
        "loads": [{"kind": "gravity", "direction": [0.0, 0.0, -1.0], "amplitude": 9.81}],
        "time": {"end": 1.5, "step": 1e-2},
        "output": {"interval": 1e-2, "points": {"corner": [0.3, 0.1, -0.2]}},
    }
)
simulation = flexframe.Simulation(flexframe.Body(falling))
simulation.add_event("on the ground", lambda row: row["points/corner/displacement"][2] + 1.5, crossing="falling")
while (reached := simulation.advance()).event is None:
    pass
bounce, closed_form = reached.time, np.sqrt(2 * 1.5 / 9.81)
print(f"{reached.event} at {bounce:.12f} s, in closed form {closed_form:.12f} s")
simulation.set_state({"velocity": -simulation.state()["velocity"]})
simulation.advance_to(2 * bounce)
print(f"back at {simulation.observe()['position'][2]:.2e} m at twice that time")

# %% [markdown]
# ## Errors
#
# Exceptions have the words of the program, and what is known of the fault in attributes.

# %%
try:
    scene.with_values({"time.stpe": 1e-4})
except flexframe.InputError as error:
    print(error)
    print("key:", error.key, "| help:", error.help)

# %% [markdown]
# ## Tables
#
# Where pandas or xarray is installed, results become a DataFrame or a Dataset with names, units and coordinates.

# %%
try:
    dataset = damped.to_xarray()
    print(dataset["points/velocity"].sel(point="tip", axis="z")[-1].item(), dataset["points/velocity"].attrs["units"])
    print(damped.to_pandas()["points/tip/velocity z"].iloc[-1])
except ImportError as missing:
    print(missing)
