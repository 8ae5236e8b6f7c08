"""A spacecraft with a reaction wheel in MuJoCo, whose panel is a flexible body of flexframe, step by step together.

Every H seconds MuJoCo says where the hub is, and flexframe moves the panel on for H, on a mount (springs and dampers) of the hub, which is taken to
go on with its velocities. What the mount has given the panel, in momentum and in angular momentum, is taken from the hub as a constant
force and moment in the same H. So both momenta of the whole are kept for any H; the error of the motion falls with H. It is told
against flexframe alone with a rigid hub on the same mount.

    ./dev cosimulation      or, with flexframe and mujoco installed:      python examples/python/mujoco_spacecraft.py
"""

import math
import pathlib

import flexframe
import mujoco
import numpy as np

MESH = pathlib.Path(__file__).resolve().parents[2] / "meshes" / "plate.msh"
END = 0.4
SLEW = 0.3
"""The wheel speeds up and down again within this time, which turns the hub."""
TORQUE = 20.0
ROWS = 0.008
MASS, WHEEL = 20.0, 1.0
INERTIA = 0.3
MOUNT = np.array([0.1, 0.0, 0.0])
STIFFNESS, DAMPING = 5e4, 40.0  # N/m and N s/m
ANGULAR = 2e3, 1.0  # N m/rad and N m s/rad
STEP = 1e-4  # of MuJoCo

# SI here; the mesh of the panel is in mm, with masses in Mg, so that forces are in N.
MM = 1e3

SPACECRAFT = f"""
<mujoco>
  <option gravity="0 0 0" timestep="{STEP}" integrator="RK4"/>
  <worldbody>
    <body name="hub">
      <freejoint/>
      <inertial pos="0 0 0" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
      <body name="wheel">
        <joint name="wheel" type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="{WHEEL}" diaginertia="0.005 0.01 0.005"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="wheel"/></actuator>
</mujoco>
"""


def torque(time: float) -> float:
    """The motor's moment on the wheel, N m; the hub gets the other way round."""
    return -TORQUE * math.sin(2 * math.pi * time / SLEW) if time < SLEW else 0.0


def panel() -> dict:
    return {
        "mesh": str(MESH),
        "material": {"young_modulus": 70000.0, "poisson_ratio": 0.33, "density": 2.7e-9},
        "modes": {"flexible": 4, "damping_ratio": 0.01},
        "markers": {"edge": {"box": [[-500, -25, 0], [-500, 25, 10]]}},
        "initial": {"position": [600, 0, -5]},
        "points": {"tip": [500, 0, 5]},
    }


def scene(bodies: dict) -> flexframe.Scene:
    return flexframe.Scene(
        {
            "title": "Spacecraft with a panel",
            "units": {"length": "mm", "mass": "Mg", "time": "s"},
            "bodies": bodies,
            "time": {"end": END, "tolerance": 1e-7},
            "output": {"interval": ROWS},
        }
    )


def rotation_vector(rotation: np.ndarray) -> np.ndarray:
    """Rotation vector of a turn by less than half a turn."""
    axial = 0.5 * np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    sine = np.linalg.norm(axial)
    return axial * (math.atan2(sine, 0.5 * (np.trace(rotation) - 1)) / sine if sine > 1e-12 else 1.0)


def mount(position, velocity, rotation, omega) -> tuple[np.ndarray, np.ndarray]:
    """Force (N) and moment (N mm) on the panel, by its motion from its place on the hub (mm): in any axes."""
    force = -(STIFFNESS * position + DAMPING * velocity) / MM
    return force, -MM * (ANGULAR[0] * rotation_vector(rotation) + ANGULAR[1] * omega)


def alone() -> tuple[np.ndarray, np.ndarray]:
    """Turn of the hub and deflection of the tip (mm) every ROWS seconds, by flexframe alone."""
    inertia = MM**2 * 1e-3 * np.diag([INERTIA + 0.005, INERTIA, INERTIA + 0.005])
    hub = {
        "rigid": {"mass": (MASS + WHEEL) * 1e-3, "center_of_mass": [0, 0, 0], "inertia": inertia},
        "markers": {"mount": {"at": MOUNT * MM}},
    }
    system = flexframe.System(scene({"hub": hub, "panel": panel()}))
    # The wheel's moment on the hub, and the mount.
    forces = [
        flexframe.MarkerForce(["hub.mount", "panel.edge"], lambda time, of: mount(of.position, of.velocity, of.rotation, of.angular_velocity)),
        flexframe.MarkerForce(["ground", "hub.mount"], lambda time, of: (np.zeros(3), MM * np.array([0, -torque(time), 0])), discontinuities=[SLEW]),
    ]
    rows = list(flexframe.Simulation(system, marker_forces=forces))
    attitude = np.array([row["bodies/hub/attitude"] for row in rows])
    return 2 * np.arctan2(attitude[:, 2], attitude[:, 0]), np.array([row["bodies/panel/points/tip/elastic_displacement_body"][2] for row in rows])


class Together:
    """MuJoCo's hub and flexframe's panel, which exchange motion and momentum every `exchange` seconds."""

    def __init__(self, exchange: float) -> None:
        self.exchange = exchange
        self.model = mujoco.MjModel.from_xml_string(SPACECRAFT)
        self.hub = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.hub)
        self.times = np.arange(exchange, END + exchange / 2, exchange)
        self.look()
        law = flexframe.MarkerForce(["ground", "panel.edge"], self.law, discontinuities=list(self.times[:-1]))
        self.panel = flexframe.Simulation(flexframe.System(scene({"panel": panel()})), marker_forces=[law])
        self.row = self.panel.observe()

    def look(self) -> None:
        """The motion of the hub as MuJoCo has it: place, velocity, attitude, angular velocity (global)."""
        attitude = np.empty(9)
        mujoco.mju_quat2Mat(attitude, self.hub.qpos[3:7])
        self.attitude = attitude.reshape(3, 3)
        self.since, self.place, self.velocity = self.hub.time, self.hub.qpos[:3].copy(), self.hub.qvel[:3].copy()
        # MuJoCo's angular velocity of a free body is along its axes.
        self.omega = self.attitude @ self.hub.qvel[3:6]

    def law(self, time: float, of: flexframe.RelativeMotion) -> tuple[np.ndarray, np.ndarray]:
        """The mount's force on the panel, global, on a hub that goes on as it was seen."""
        gone = time - self.since
        turned = np.empty(9)
        quaternion = np.empty(4)
        speed = np.linalg.norm(self.omega)
        mujoco.mju_axisAngle2Quat(quaternion, self.omega / speed if speed > 0 else np.array([1.0, 0, 0]), speed * gone)
        mujoco.mju_quat2Mat(turned, quaternion)
        attitude = turned.reshape(3, 3) @ self.attitude
        arm = attitude @ MOUNT
        # The marker of the ground is where the mount is at the start.
        place = MM * (self.place + self.velocity * gone + arm - MOUNT)
        velocity = MM * (self.velocity + np.cross(self.omega, arm))
        return mount(of.position - place, of.velocity - velocity, of.rotation @ attitude.T, of.angular_velocity - self.omega)

    def step(self, end: float) -> None:
        self.panel.advance_to(end)
        before, self.row = self.row, self.panel.observe()
        gained = lambda path: self.row[path] - before[path]
        force = -gained("system/momentum/linear") / self.exchange
        # r × F over the step, of a hub that F accelerates.
        h, place, velocity = self.exchange, self.place, self.velocity
        arm = place * h + velocity * h**2 / 2 + force / (MASS + WHEEL) * h**3 / 6
        moment = (-gained("system/momentum/angular") / MM - np.cross(arm, force)) / h
        hub = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, "hub")
        self.hub.xfrc_applied[hub] = np.concatenate([force, moment])
        for _ in range(round(h / STEP)):
            self.hub.ctrl[0] = torque(self.hub.time + STEP / 2)
            mujoco.mj_step(self.model, self.hub)
        self.look()

    def momenta(self) -> np.ndarray:
        """Linear and angular momentum of hub, wheel and panel, about the global origin: N s and N m s."""
        mujoco.mj_forward(self.model, self.hub)
        mujoco.mj_subtreeVel(self.model, self.hub)
        linear = (MASS + WHEEL) * self.hub.subtree_linvel[0]
        angular = self.hub.subtree_angmom[0] + np.cross(self.hub.subtree_com[0], linear)
        return np.concatenate([linear + self.row["system/momentum/linear"], angular + self.row["system/momentum/angular"] / MM])


def together(exchange: float) -> dict[str, np.ndarray | float]:
    """The same motion, in exchanges of so many seconds."""
    craft = Together(exchange)
    turns, deflections, most, moved = [0.0], [0.0], 0.0, 0.0
    for number, time in enumerate(craft.times, 1):
        craft.step(time)
        most = max(most, np.abs(craft.momenta()).max())
        moved = max(moved, np.abs(craft.row["system/momentum/linear"]).max(), np.abs(craft.row["system/momentum/angular"]).max() / MM)
        if number % round(ROWS / exchange) == 0:
            turns.append(2 * math.atan2(craft.hub.qpos[5], craft.hub.qpos[3]))
            deflections.append(craft.row["points/elastic_displacement_body"][0][2])
    return {"turn": np.array(turns), "deflection": np.array(deflections), "momentum": most / moved}


def compare() -> list[dict[str, float]]:
    """Runs all, prints what they do, and returns errors by exchange step."""
    turn, deflection = alone()
    print(f"flexframe alone: the hub turns by {np.degrees(turn[-1]):.3f}°, the tip deflects by {np.abs(deflection).max():.3f} mm")
    rows = []
    for exchange in [4e-3, 2e-3, 1e-3]:
        found = together(exchange)
        row = {
            "exchange": exchange,
            "turn": np.abs(found["turn"] - turn).max() / np.abs(turn).max(),
            "deflection": np.abs(found["deflection"] - deflection).max() / np.abs(deflection).max(),
            "momentum": found["momentum"],
        }
        rows.append(row)
        print(
            f"exchange {exchange * 1e3:5.2f} ms: turn off by {row['turn']:.2e}, deflection by {row['deflection']:.2e} of the largest; "
            f"momenta of the whole {row['momentum']:.1e} of those exchanged"
        )
    return rows


if __name__ == "__main__":
    rows = compare()
    for row in rows:
        assert row["momentum"] < 1e-10, row
    for coarse, fine in zip(rows, rows[1:]):
        assert fine["turn"] < 0.6 * coarse["turn"] and fine["deflection"] < 0.6 * coarse["deflection"], (coarse, fine)
