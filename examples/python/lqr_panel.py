"""A satellite whose flexible panel swings on its hinge, damped by an LQR with a Kalman filter (python-control).

The controller is designed with the linear model of `flexframe.linearize`, and then moves the nonlinear system: every 5 ms it reads the
angle of the hinge, and holds a moment. Energy is what the moment has done less what damping has taken.

    ./dev cosimulation      or, with flexframe and control installed:      python examples/python/lqr_panel.py
"""

import math
import pathlib

import control
import flexframe
import numpy as np

MESH = pathlib.Path(__file__).resolve().parents[2] / "meshes" / "plate.msh"
SAMPLE = 0.005
END = 4.0
ORDER = 4
"""States of the controller: the hinge, and the first bending."""
TURN = 0.4
"""The panel begins so far from the rest of its spring, in radians."""


def satellite(turn: float) -> flexframe.Scene:
    """A free hub with a panel on a hinge that is turned back by `turn` from where its spring has no moment. Units: mm, Mg, s."""
    # The mesh is turned about y, with the middle of its edge at (-500, 0, 5) on the hub at (100, 0, 0).
    cos, sin = math.cos(-turn), math.sin(-turn)
    edge = np.array([-500 * cos + 5 * sin, 0, 500 * sin + 5 * cos])
    return flexframe.Scene(
        {
            "title": "Satellite with a panel",
            "units": {"length": "mm", "mass": "Mg", "time": "s"},
            "bodies": {
                "hub": {
                    "rigid": {"mass": 0.02, "center_of_mass": [0, 0, 0], "inertia": np.diag([300.0, 300.0, 300.0])},
                    "markers": {"edge": {"at": [100, 0, 0]}},
                },
                "panel": {
                    "mesh": str(MESH),
                    "material": {"young_modulus": 70000.0, "poisson_ratio": 0.33, "density": 2.7e-9},
                    "modes": {"flexible": 6, "damping_ratio": 0.005},
                    "markers": {"hinge": {"box": [[-500, -25, 0], [-500, 25, 10]]}},
                    "initial": {"position": np.array([100, 0, 0]) - edge, "attitude": [math.cos(turn / 2), 0, -math.sin(turn / 2), 0]},
                    "points": {"tip": [500, 0, 5]},
                },
            },
            "joints": [
                {
                    "name": "hinge",
                    "kind": "revolute",
                    "between": ["hub.edge", "panel.hinge"],
                    "axis": [0, 1, 0],
                    "spring": {"stiffness": 3e4, "damping": 20.0, "free": turn},
                }
            ],
            "time": {"end": END, "tolerance": 1e-10},
            "output": {"interval": SAMPLE},
        }
    )


def slowest(a: np.ndarray, b: np.ndarray, c: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The part of a model that its slowest vibrations move: real and imaginary parts of their shapes are the states."""
    poles, shapes = np.linalg.eig(a)
    pairs = np.array([k for k in np.argsort(abs(poles)) if poles[k].imag > 0][: order // 2])
    own = np.column_stack([part for k in pairs for part in (shapes[:, k].real, shapes[:, k].imag)])
    others = np.column_stack([part for k in range(len(a)) if poles[k].imag > 0 and k not in pairs for part in (shapes[:, k].real, shapes[:, k].imag)])
    change = np.linalg.inv(np.hstack([own, others]))[:order]
    return change @ a @ own, change @ b, c @ own


class Controller:
    """A discrete LQR on the states of a Kalman filter, which sees the angle of the hinge."""

    def __init__(self) -> None:
        model = flexframe.linearize(satellite(0.0), inputs=["hinge.turn"], outputs=["hinge.turn"])
        # The moment is between the bodies: the motion of both together, which nothing resists, is beyond it. States are places, then rates.
        count = len(model.states) // 2
        inner = np.flatnonzero(np.abs(model.A[count:, :count]).max(axis=1) > 0)
        kept = np.concatenate([inner, count + inner])
        whole = control.ss(model.A[np.ix_(kept, kept)], model.B[kept], model.C[:, kept], model.D)
        slow = slowest(whole.A, whole.B, whole.C, ORDER)
        self.poles = np.array(sorted(np.linalg.eigvals(slow[0]), key=abs))
        discrete = control.sample_system(control.ss(*slow, model.D), SAMPLE)
        self.a, self.b, self.c = discrete.A, discrete.B, discrete.C[:1]
        # Before, a moment holds the panel, against the spring alone.
        self.held = np.linalg.solve(np.eye(ORDER) - self.a, self.b)[:, 0]
        # Weights: 0.1 rad and 1 rad/s of the hinge, 3 N m of the motor.
        scaled = discrete.C / np.array([[0.1], [1.0]])
        self.gain, _, _ = control.dlqr(self.a, self.b, scaled.T @ scaled, np.eye(1) / 3e3**2)
        # Disturbances are moments of 0.1 N m at the hinge, the noise of the sensor 1 mrad.
        self.filter, _, _ = control.dlqe(self.a, self.b, self.c, np.eye(1) * 100.0**2, np.eye(1) * 1e-3**2)
        self.closed = self.closed_loop(control.sample_system(whole, SAMPLE))

    def closed_loop(self, whole: control.StateSpace) -> np.ndarray:
        """Poles, per second, of the loop with all vibrations of the linear model, also those that the controller does not know."""
        corrected, law = np.eye(ORDER) - self.filter @ self.c, self.b @ self.gain
        seen = self.filter @ whole.C[:1]
        loop = np.block([
            [whole.A - whole.B @ self.gain @ seen, -whole.B @ self.gain @ corrected],
            [(self.a - law) @ seen, (self.a - law) @ corrected],
        ])
        return np.log(np.linalg.eigvals(loop).astype(complex)) / SAMPLE

    def begin(self, angle: float) -> None:
        """The filter begins with the panel held at an angle."""
        self.state = self.held * angle / (self.c @ self.held)[0]

    def moment(self, angle: float) -> float:
        """The moment for the next sample."""
        error = np.array([angle]) - self.c @ self.state
        self.state = self.state + self.filter @ error
        moment = float((-self.gain @ self.state)[0])
        self.state = self.a @ self.state + self.b[:, 0] * moment
        return moment


def run(controller: Controller | None) -> dict[str, np.ndarray | float]:
    """The motion with a controller or without: what the hinge and the tip do, and where the energy goes."""
    held = [0.0]
    times = np.arange(0.0, END + SAMPLE / 2, SAMPLE)
    # The moment jumps at each sample: steps end there.
    motor = flexframe.JointForce("hinge", lambda time, angle, rate: held[0], discontinuities=list(times[1:-1]))
    simulation = flexframe.Simulation(flexframe.System(satellite(TURN)), joint_forces=[motor])
    row = simulation.observe()
    if controller:
        controller.begin(row["joints/hinge/angle"] - TURN)
    rows, moments, work = [row], [], 0.0
    for time in times[1:]:
        if controller:
            held[0] = controller.moment(row["joints/hinge/angle"] - TURN)
        moments.append(held[0])
        simulation.advance_to(time)
        before, row = row, simulation.observe()
        work += held[0] * (row["joints/hinge/angle"] - before["joints/hinge/angle"])
        rows.append(row)
    column = lambda path: np.array([row[path] for row in rows])
    # The spring's own energy is 1/2 k a² of the turn that is left; its damper's part is the loss.
    spring = 0.5 * 3e4 * (column("joints/hinge/angle") - TURN) ** 2
    energy = column("system/energy/total") + spring
    loss = column("system/energy/dissipation") + column("joints/hinge/loss")
    return {
        "time": times,
        "angle": column("joints/hinge/angle") - TURN,
        "moment": np.array(moments),
        "energy": energy,
        "work": work,
        "loss": loss[-1] - loss[0],
        "momentum": np.abs(column("system/momentum/angular")).max(),
        "deflection": column("bodies/panel/points/tip/elastic_displacement_body")[:, 2],
    }


def settled(motion: dict) -> float:
    """When the energy falls below a thousandth for good; infinity where it does not."""
    last = np.flatnonzero(motion["energy"] > 1e-3 * motion["energy"][0])[-1]
    return float(motion["time"][last + 1]) if last + 1 < len(motion["time"]) else np.inf


def compare() -> dict[str, float]:
    """Runs both, prints what they do, and returns the numbers."""
    controller = Controller()
    assert (controller.closed.real < 0).all(), "the closed loop of the linear model is unstable"
    free, damped = run(None), run(controller)
    numbers = {}
    slow = min(controller.closed, key=abs)
    print(f"linear model: hinge {controller.poles[1]:.3f}, first bending {controller.poles[3]:.3f}, in the loop {slow:.3f} per second")
    for name, motion in [("free", free), ("LQR", damped)]:
        first, last = motion["energy"][[0, -1]]
        gap = last - first - motion["work"] + motion["loss"]
        numbers |= {f"{name} settled": settled(motion), f"{name} gap": abs(gap) / first, f"{name} left": last / first}
        print(
            f"{name:>5}: energy {first:.1f} to {last:.3g} mJ, work {motion['work']:.1f}, loss {motion['loss']:.1f}, "
            f"not accounted for {abs(gap) / first:.1e} of the first; "
            f"{f'below 1/1000 at {settled(motion):.2f} s' if np.isfinite(settled(motion)) else 'never below 1/1000'}; "
            f"tip deflects by {np.abs(motion['deflection']).max():.1f} mm; largest moment {np.abs(motion['moment']).max() / 1e3:.2f} N m"
        )
    return numbers


if __name__ == "__main__":
    numbers = compare()
    assert numbers["free gap"] < 1e-6 and numbers["LQR gap"] < 1e-6
    assert numbers["LQR settled"] < 0.5 * numbers["free settled"]
