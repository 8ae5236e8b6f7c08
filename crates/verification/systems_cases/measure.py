"""Every scene of this folder by one or two programs, with the error against what is right, as a table.

Usage: measure.py PROGRAM [BEFORE]
Right values are those of the reference of `random_systems`, of closed forms, or constants of the motion; each case says which.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "random_systems"))
import h5py
import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

import generate
import reference

SECONDS = 60
# Of a message in the table.
LONGEST = 90
EYE = np.eye(3)


def load(scene, drives=True):
    """The system of a scene of rigid bodies whose laws are gravity and springs of joints, without drives: for the reference."""
    data = tomllib.loads((HERE / f"{scene}.toml").read_text())
    bodies, names = [], []
    tables = data.get("bodies") or {"body": {**data["body"], "initial": data.get("initial", {}), "loads": data.get("loads", [])}}
    gravity = np.zeros(3)
    for name, table in tables.items():
        rigid, initial = table["rigid"], table.get("initial", {})
        q = np.array(initial.get("attitude", [1, 0, 0, 0]), float)
        q /= np.linalg.norm(q)
        com = np.array(rigid["center_of_mass"], float)
        x = np.array(initial.get("position", [0, 0, 0]), float) + reference.rotation(q) @ com
        for l in table.get("loads", []):
            if l["kind"] == "gravity":
                gravity = l["amplitude"] * np.array(l["direction"], float) / np.linalg.norm(l["direction"])
        names.append(name)
        bodies.append({"name": name, "mass": rigid["mass"], "inertia": rigid["inertia"], "com": com, "place": x, "attitude": q, "point": False,
                       "velocity": initial.get("velocity", [0, 0, 0]), "omega": initial.get("angular_velocity", [0, 0, 0])})
    # Distances from the first body, so that places far away have no rounding.
    middle = bodies[0]["place"].copy() if np.linalg.norm(bodies[0]["place"]) > 1e4 else np.zeros(3)
    for body in bodies:
        body["place"] = body["place"] - middle

    def end(text, other, axis):
        name, _, label = text.partition(".")
        b = -1 if name == "ground" else names.index(name)
        table = data.get("ground", {}) if b < 0 else tables[name]
        marker = table.get("markers", {}).get(label) if label else None
        x, r = (np.zeros(3), EYE) if b < 0 else (bodies[b]["place"], reference.rotation(bodies[b]["attitude"]))
        if marker is None:
            s = other[0]
        else:
            s = x + r @ (np.array(marker["at"], float) - (0 if b < 0 else bodies[b]["com"]))
        axes = generate.frame_of(r @ np.array(marker["z"], float), r @ np.array(marker["x"], float)) if marker and "z" in marker else generate.frame_of(np.array(axis, float))
        return b, s, axes, x, r

    joints = []
    for joint in data.get("joints", []):
        i, j = joint["between"]
        axis = joint.get("axis", [0, 0, 1])
        second = end(j, None, axis) if j != "ground" else None
        first = end(i, (second or [0, 0])[1:2], axis)
        second = second or end(j, (first[1],), axis)
        one = lambda e: {"body": e[0], "s": (e[4].T @ (e[1] - e[3])).tolist(), "axes": (e[4].T @ e[2]).tolist()}
        out = {"name": joint.get("name"), "kind": joint["kind"], "i": one(first), "j": one(second), "along": "slide" if joint["kind"] == "prismatic" else "turn"}
        if "spring" in joint:
            out["spring"] = {"stiffness": 0.0, "damping": 0.0, "free": 0.0, **joint["spring"]}
        if "drive" in joint and drives:
            # A polynomial in t: t itself here.
            assert joint["drive"]["history"]["formula"] == "t", scene
            out["drive"] = {"rate": joint["drive"]["amplitude"]}
        joints.append(out)
    places = [b["place"] for b in bodies]
    size = max(1.0, max(np.linalg.norm(p - q) for p in places for q in places))
    return {"bodies": bodies, "joints": joints, "gravity": gravity.tolist(), "size": float(size), "middle": middle}, data


class Run:
    """What a program made of a scene."""

    def __init__(self, program, scene, command="run"):
        self.error, self.said, self.rows, self.columns = None, {}, None, {}
        with tempfile.TemporaryDirectory() as work:
            words = ["nice", program, command, str(HERE / f"{scene}.toml"), "--json"]
            if command == "run":
                words += ["-o", work, "--no-check"]
            try:
                done = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS, env={**os.environ, "FLEXFRAME_CACHE": "", "RAYON_NUM_THREADS": "1"})
            except subprocess.TimeoutExpired:
                self.error = f"more than {SECONDS} s"
                return
            if done.returncode:
                for line in done.stderr.strip().splitlines()[::-1]:
                    try:
                        self.error = json.loads(line)["message"].replace(work, "").replace(str(HERE), "").split(" (the states")[0]
                        break
                    except (ValueError, KeyError):
                        continue
                self.error = self.error or f"exit code {done.returncode}"
                return
            self.said = json.loads(done.stdout)
            if command == "run":
                found = [f for f in Path(work).glob("*.h5") if ".part" not in f.name]
                with h5py.File(found[0]) as file:
                    file.visititems(lambda name, item: self.columns.__setitem__(name, np.array(item)) if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and "model" not in name else None)
                self.columns["time"] = self.columns.get("time")

    def body(self, name, key):
        return self.columns[f"bodies/{name}/{key}"]

    def states(self, system, away=0.0):
        lot = []
        for b in system["bodies"]:
            q = self.body(b["name"], "attitude")
            w = np.einsum("tij,tj->ti", reference.rotation(q), self.body(b["name"], "angular_velocity"))
            lot.append((self.body(b["name"], "position") - away, q, self.body(b["name"], "velocity"), w))
        return [np.concatenate([np.ravel([b[part][k] for b in lot]) for part in range(4)]) for k in range(len(self.columns["time"]))]

    def card(self):
        lines = [l["error"] for l in self.said.get("trust", {}).get("lines", []) if l["place"] == "steps" and l["error"] is not None]
        return f"card {max(lines):.0e}" if lines else ""


def against_reference(scene, about_center=False):
    """The largest error of place over size and attitude at any row, against DOP853 in maximal coordinates."""
    system, data = load(scene)
    ref = reference.Reference(system)
    interval, end = data["output"]["interval"], data["time"]["end"]
    kept = {}

    def measure(run):
        rows = np.array(run.states(system, system["middle"]))
        times = run.columns["time"]
        if "rows" not in kept:
            start = ref.start(system["bodies"])
            start, _ = ref.close(0.0, start)
            kept["rows"] = ref.run(start, list(times), 1e-10, most=400000)
        n = ref.n
        other = kept["rows"]
        if about_center:
            # Motion about the center of mass of all.
            def relative(lot):
                lot = [row.copy() for row in lot]
                for row in lot:
                    x = row[: 3 * n].reshape(n, 3)
                    row[: 3 * n] = (x - ref.mass @ x / ref.mass.sum()).ravel()
                return lot
            rows, other = relative(rows), relative(other)
        return max(reference.distance(rows, other, n, system["size"], [False] * n)), "over size, rad: reference in maximal coordinates"

    return measure


def residuals(scene):
    """The largest distance of what joints hold together, over the size, at any row: places and axes of hinges."""
    def measure(run):
        return open_by(run, scene), "open joints, over size"
    return measure


def open_by(run, scene):
    """By the residuals of the reference's rows, without drives."""
    system, _ = load(scene, drives=False)
    ref = reference.Reference(system)
    return max(ref.residual(0.0, row)[0] for row in run.states(system)) / system["size"]


def no_answer(run):
    return math.nan, "an error that names both is right"


def wall(run):
    moment = run.columns["joints/wall/moment"]
    moved = max(np.abs(run.body(b, "position") - run.body(b, "position")[0]).max() for b in ("arm", "fitting"))
    return max(abs(np.linalg.norm(moment, axis=1) - 10.791).max() / 10.791, moved), "moment of the wall 10.791 N m, nothing moves"


def gear(run):
    one, two = run.columns["joints/h/angle"], run.columns["joints/k/angle"]
    return max(np.abs(one + 2.5 * two).max(), abs(one[-1] - 20), abs(two[-1] + 8)), "rad: ratio in every row, 20 and -8 rad at the end"


def counted(run):
    angle, q = run.columns["joints/h/angle"], run.body("rotor", "attitude")
    off = max(abs(math.remainder(a - 2 * math.atan2(p[3], p[0]), 2 * math.pi)) for a, p in zip(angle, q))
    return max(off, abs(angle[-1] - 20)), "rad: angle against attitude, 20 rad at the end"


def bob(run):
    times = run.columns["time"]
    found = solve_ivp(lambda t, y: [y[1], -9.81 * math.sin(y[0])], (0, 1), [1.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13, t_eval=times)
    x = run.columns.get("bodies/body/position")[:, 0]
    right = np.sin(found.y[0])
    return min(np.abs(x - right).max(), np.abs(x + right).max()), "m: swing of a point"


def half_turn(run):
    x, t = run.body("body", "position"), run.columns["time"]
    right = 0.7 * np.stack((np.cos(math.pi + t), 0 * t, -np.sin(math.pi + t)), 1)
    return np.abs(x - right).max(), "m: pi + t about y"


def four_bar(other):
    """Where the rocker begins, against the circle of its pin."""
    def measure(run):
        q = run.body("rocker", "attitude")[0]
        crank = run.body("crank", "attitude")[0]
        r, c = reference.rotation(q), reference.rotation(crank)
        pin, tip = np.array([201, 0, 0]) + r @ [120, 0, 0], c @ [0, 0, 60]
        closed = abs(np.linalg.norm(pin - tip) - 200) / 200
        return max(closed, 2 * np.linalg.norm(crank[1:])), f"crank at 0 as driven, coupler 200 mm; rocker begins at {math.degrees(2 * math.atan2(q[2], q[0])):.6f} deg"
    return measure


def frequency(right):
    def measure(run):
        lot = [m["frequency"] for s in run.said["systems"] for m in s["modes"]]
        near = min(lot, key=lambda f: abs(f - right), default=math.nan)
        return abs(near / right - 1) if lot else math.nan, f"{right} Hz; told: {', '.join(f'{f:.4g}' for f in lot) or 'none'}"
    return measure


# √(m a l / (J + m l²)) of the bob behind a cart that 2300 N push with 2 m/s².
PUSHED = round(math.sqrt(150.0 * 2.0 * 0.8 / (1e-3 + 150.0 * 0.8**2)) / (2 * math.pi), 6)


def slow_frequency(run):
    # Both bodies turn about the hinge; the spring of 1e9 N/m gives by some 1e-12 m.
    inertia, moment = 1.0 + 1e-3 + 1e-4, (1.0 + 1e-4) * 9.81
    return frequency(round(math.sqrt(moment / inertia) / (2 * math.pi), 5))(run)


def held(run):
    turned = 2 * np.linalg.norm(run.body("body", "attitude")[-1][1:])
    # Creep of the regularisation: 0.95 of the force is at atanh(0.95) of its rate.
    return abs(turned - 1e-5 * math.atanh(0.95)), "rad: it holds, but for the creep of its regularisation"


def rest(run):
    last = [np.abs(run.body(b, "velocity")[-1]).max() for b in ("l0", "l1", "l2")]
    # Three turns of moments F L over k.
    right = sum(1000.0 * arm * arm for arm in (2.4, 1.6, 0.8)) / 1e8
    z = run.body("l2", "position")[-1][2] - 0.0
    turned = [1000.0 * arm / 1e8 for arm in (2.4, 1.6, 0.8)]
    at = -(0.8 * turned[0] + 0.8 * (turned[0] + turned[1]) + 0.4 * sum(turned))
    return max(max(last), abs(z - at)), "m, m/s: rests at the deflection of its springs until the end"


def ring(run):
    u = run.body("bar", "points/tip/displacement") if "bodies/bar/points/tip/displacement" in run.columns else run.columns["bodies/bar/points/displacement"][:, 0]
    t = run.columns["time"]
    late = u[t > 2.3][:, 2]
    swing = (late.max() - late.min()) / 2
    return abs(swing / 0.97e-3 - 1), f"tip vibrates by .97 mm; found {1e3 * swing:.3g} mm"


def pendulum(run):
    """From the horizontal: Jacobi's functions. The arm is 1 m, its inertia about the hinge 1.001 kg m²."""
    times, modulus = run.columns["time"], 0.5
    sine = ellipj(ellipk(modulus) + math.sqrt(9.81 / 1.001) * times, modulus)[0]
    right = 2 * np.arcsin(math.sqrt(modulus) * sine)
    angle = run.columns["joints/h/angle"]
    return np.hypot(np.cos(angle) - np.sin(right), np.sin(angle) - np.cos(right)).max(), "m: the bob, by the closed form"


def windows(run):
    q = run.body("crank0", "attitude")[-1]
    tip = reference.rotation(q)[:2, 0]
    return math.hypot(tip[0] - 0.3284573768, tip[1] - 0.9445187937), "m: B0 after 10 s, by the library"


CASES = {
    "a0_hinge_first": wall, "a0_wall_first": wall, "a1_a": no_answer, "a1_g": no_answer, "a1_h": no_answer,
    "f0_angle_off_by_a_turn": counted, "f0_gear_that_skips": gear, "f1_bob_falls_off_its_hinge": bob,
    "f2_three_cranks_tear_apart": "open", "f2_three_cranks_equal_move": "open", "f2_stewart_universal_both_ends_torn": "open",
    "f3_drive_begins_at_pi": half_turn, "f4_four_bar_1_mm_off_with_a_spring": four_bar(0), "f4_four_bar_1_mm_off_without": four_bar(1),
    "f5_pendulum_behind_an_accelerated_cart": frequency(PUSHED), "f6_slow_mode_lost": slow_frequency,
    "f7_arm_held_by_friction_95_percent": held, "f8_stiff_arm_dies_at_rest": rest, "f10_parallelogram_flat_driven": "open",
    "bennett": "reference", "bricard": "reference", "sarrus": "open", "ring_joint": ring, "ring_clamp": ring,
    "free4": "center", "free4_300": "center", "free4_orbit": "center", "tolerance_alone": "reference", "tolerance_tied": "reference",
    "iftomm_pendulum": pendulum, "iftomm_windows_1e-4": windows, "iftomm_windows_1e-6": windows, "iftomm_windows_1e-8": windows,
}
MODES = {"f5_pendulum_behind_an_accelerated_cart", "f6_slow_mode_lost"}


def measure_of(scene):
    how = CASES[scene]
    if how == "open":
        return residuals(scene)
    if how in ("reference", "center"):
        return against_reference(scene, how == "center")
    return how


def cell(program, scene, measure):
    run = Run(program, scene, "modes" if scene in MODES else "run")
    if run.error:
        # Without the name of the scene, and no more than the beginning.
        text = "error: " + run.error.removeprefix(f"/{scene}.toml: ")
        return text if len(text) <= LONGEST else text[:LONGEST].rstrip() + " …", None
    try:
        error, what = measure(run)
    except (reference.Unsure, KeyError) as missing:
        return f"not measured: {missing!r}; {run.card()}", None
    steps = run.said.get("steps")
    shown = f"{error:.1e}" if math.isfinite(error) else "no error said" if measure is no_answer else "not told"
    return shown + (f", {steps} steps" if steps else "") + (f"; {run.card()}" if run.card() else ""), what


def main():
    words = sys.argv[1:]
    programs = words[::-1]
    head = ["before", "found"][2 - len(programs):]
    print("| case | " + " | ".join(head) + " | measured |\n|---|" + "---|" * (len(programs) + 1))
    for scene in CASES:
        measure, cells, what = measure_of(scene), [], ""
        for program in programs:
            text, found = cell(program, scene, measure)
            cells.append(text.replace("|", "/").replace("\n", " "))
            what = found or what
        print(f"| `{scene}` | " + " | ".join(cells) + f" | {what} |", flush=True)


if __name__ == "__main__":
    main()
