"""The reference against closed forms and constants: pendulum, spherical pendulum, top, double pendulum, Bennett's linkage."""

import math

import numpy as np
from scipy.special import ellipk

import generate
import reference

EYE = np.eye(3)


def system(bodies, joints, gravity=(0, 0, -9.81), size=1.0):
    for k, body in enumerate(bodies):
        body.setdefault("attitude", [1, 0, 0, 0])
        body.setdefault("velocity", [0, 0, 0])
        body.setdefault("omega", [0, 0, 0])
    return {"bodies": bodies, "joints": joints, "gravity": list(gravity), "size": size}


def joint(kind, i, si, j, sj, axes=EYE):
    end = lambda b, s: {"body": b, "s": list(s), "axes": np.array(axes).tolist()}
    return {"name": "j", "kind": kind, "i": end(i, si), "j": end(j, sj), "along": "turn"}


def tell(what, error, most):
    print(f"{what}: {error:.1e}")
    if not error < most:
        raise SystemExit(f"{what}: {error:.1e} is not below {most:.0e}")


def pendulum():
    """A bar of 1 m on a hinge, let go at 1 rad: after a period it is back."""
    j = 1 / 3
    s = system([{"mass": 1.0, "inertia": (np.eye(3) / 12).tolist(), "place": [0.5 * math.sin(1), 0, -0.5 * math.cos(1)],
                 "attitude": [math.cos(0.5), 0, -math.sin(0.5), 0]}],
               [joint("revolute", -1, (0, 0, 0), 0, (0, 0, 0.5), generate.frame_of(np.array([0, 1.0, 0])))])
    ref = reference.Reference(s)
    start = ref.start(s["bodies"])
    tell("pendulum, start", ref.residual(0.0, start)[0], 1e-14)
    quarter = ellipk(math.sin(0.5) ** 2) / math.sqrt(9.81 * 0.5 / j)
    rows = ref.run(start, [0, quarter, 2 * quarter, 4 * quarter], 1e-11)
    tell("pendulum, lowest point after a quarter of a period", abs(rows[1][0]), 1e-9)
    tell("pendulum, back after a period", np.linalg.norm(rows[3][:3] - rows[0][:3]), 1e-9)


def spherical_pendulum():
    """A point on a ball, round in a cone of 0.7 rad."""
    tilt, length = 0.7, 2.0
    omega = math.sqrt(9.81 / (length * math.cos(tilt)))
    r = length * math.sin(tilt)
    s = system([{"mass": 3.0, "inertia": (np.eye(3) * 1e-5).tolist(), "place": [r, 0, -length * math.cos(tilt)], "velocity": [0, omega * r, 0], "omega": [0, 0, omega]}],
               [joint("spherical", -1, (0, 0, 0), 0, (-r, 0, length * math.cos(tilt)))], size=2.0)
    ref = reference.Reference(s)
    t = 1.3
    rows = ref.run(ref.start(s["bodies"]), [0, t], 1e-11)
    tell("spherical pendulum in a cone", np.linalg.norm(rows[1][:2] - r * np.array([math.cos(omega * t), math.sin(omega * t)])), 1e-8)


def top():
    """A symmetric top in steady precession, of the exact rate (the slow root)."""
    tilt, l, spin, m, ct, ca = 0.5, 0.3, 80.0, 1.0, 0.02, 0.03
    j = ct + m * l * l
    # j cos(tilt) W^2 - ca wz W + m g l = 0, wz the spin along the axis.
    wz = spin
    slow = (ca * wz - math.sqrt((ca * wz) ** 2 - 4 * j * math.cos(tilt) * m * 9.81 * l)) / (2 * j * math.cos(tilt))
    axis = np.array([math.sin(tilt), 0, math.cos(tilt)])
    q = reference.small_turn(tilt * np.array([0, 1.0, 0]))
    # In body axes: precession about the vertical less its part along the axis, and the spin.
    w = slow * np.array([0, 0, 1.0])
    w = w - axis * (w @ axis) + axis * wz
    s = system([{"mass": m, "inertia": np.diag([ct, ct, ca]).tolist(), "place": (l * axis).tolist(), "attitude": q.tolist(),
                 "velocity": np.cross(w, l * axis).tolist(), "omega": (reference.rotation(q).T @ w).tolist()}],
               [joint("spherical", -1, (0, 0, 0), 0, (0, 0, -l))])
    ref = reference.Reference(s)
    rows = ref.run(ref.start(s["bodies"]), [0, 0.5], 1e-11)
    turned = slow * 0.5
    tell("top in steady precession", np.linalg.norm(rows[1][:3] - l * np.array([math.sin(tilt) * math.cos(turned), math.sin(tilt) * math.sin(turned), math.cos(tilt)])), 1e-8)


def energies():
    """A double pendulum, and a chain of all kinds of joints without laws: energy stays; so does a free system's momentum."""
    hinge = generate.frame_of(np.array([0, 1.0, 0]))
    s = system([{"mass": 1.0, "inertia": (np.eye(3) / 12).tolist(), "place": [0.5, 0, 0], "omega": [0, 1, 0], "velocity": [0, 0, -0.5]},
                {"mass": 2.0, "inertia": (np.eye(3) / 6).tolist(), "place": [1.5, 0, 0], "omega": [0, 0, 0], "velocity": [0, 0, -1.0]}],
               [joint("revolute", -1, (0, 0, 0), 0, (-0.5, 0, 0), hinge), joint("revolute", 0, (0.5, 0, 0), 1, (-0.5, 0, 0), hinge)])
    ref = reference.Reference(s)
    rows = ref.run(ref.start(s["bodies"]), [0, 1, 2], 1e-11, most=100000)
    tell("double pendulum, energy over 2 s", abs(ref.energy(rows[2]) - ref.energy(rows[0])) / 10, 1e-9)
    for kind in generate.KINDS:
        rng = np.random.default_rng(7)
        m = generate.Maker(rng)
        m.body(np.zeros(3), generate.random_rotation(rng))
        m.hang(0, kind)
        m.hang(1, kind)
        for b in m.bodies:
            b.update(attitude=reference.quaternion(b["matrix"]).tolist(), velocity=rng.normal(size=3).tolist(), omega=rng.normal(size=3).tolist())
        s = system(m.bodies, m.joints, (0, 0, 0), m.size)
        ref = reference.Reference(s)
        start, _ = ref.close(0.0, ref.start(s["bodies"]))
        rows = ref.run(start, [0, 1.0], 1e-11)
        n = ref.n
        momentum = lambda y: ref.mass @ y[7 * n : 10 * n].reshape(n, 3)
        tell(f"free chain of {kind} joints, energy", abs(ref.energy(rows[1]) / ref.energy(rows[0]) - 1), 1e-9)
        tell(f"free chain of {kind} joints, momentum", np.linalg.norm(momentum(rows[1]) - momentum(rows[0])) / np.linalg.norm(momentum(start)), 1e-9)


if __name__ == "__main__":
    pendulum()
    spherical_pendulum()
    top()
    energies()
