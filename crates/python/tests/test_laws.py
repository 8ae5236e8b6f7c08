"""Functions of Python as loads and events."""

import os
import re
import subprocess

import numpy as np
import pytest
from conftest import EXAMPLES, RIGID, RING

import flexframe


def printed_by(example):
    """Numbers that an example in Rust prints."""
    said = subprocess.run([os.path.join(os.environ["FLEXFRAME_EXAMPLES"], example)], capture_output=True, text=True, check=True)
    return [float(number) for number in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", said.stdout)]


# Conserved: the same energy as of the example in Rust, and the balance of energy.
def test_a_controller_is_that_of_the_example_in_rust():
    scene = flexframe.Scene(EXAMPLES / "plate.toml").with_values(
        {
            "modes.damping_ratio": 0.0,
            "modes.static_correction": False,
            "effects": {"geometric_stiffening": False, "large_deflection": False, "deformed_inertia": True,
                        "coriolis": True, "refuse": False},
            "initial.modal_velocity": [20.0],
            "loads": [],
            "time": {"end": 0.2, "step": 1e-5, "scheme": "exponential"},
            "output": {"interval": 0.2, "points": {"P1": [-500.0, -25.0, 0.0]}},
        }
    )
    body = flexframe.Body(scene)
    damper = flexframe.Force("P1", lambda motion: -0.2 * (motion.velocity() - motion.origin_velocity))
    free = flexframe.Simulation(body).run()
    damped = flexframe.Simulation(body, [damper]).run()
    energy = lambda results: results["energy/kinetic"] + results["energy/strain"]
    left, _ = printed_by("controller")
    assert 0.01 < left < 0.9
    assert energy(damped)[-1] / energy(free)[-1] == pytest.approx(left, rel=1e-12)
    balance = damped["energy/balance"]
    assert abs(balance[-1] - balance[0]) < 1e-6 * energy(damped)[0]
    assert damped["energy/work"][-1] < -0.1 * energy(damped)[0]


# Conserved: the same numbers as of the example in Rust, which are held against closed forms.
def test_a_spring_and_a_thrust_are_those_of_the_example_in_rust():
    after_a_period, energy, circled, closed = printed_by("spring_to_ground")
    anchor, stiffness, mass = np.array([-0.1, 0.0, 0.0]), 50.0, 2.0
    period = 2 * np.pi * np.sqrt(mass / stiffness)
    scene = flexframe.Scene({**RIGID, "time": {"end": period, "step": 1e-3}}).with_values({"output.interval": period})
    spring = flexframe.Force("center", lambda motion: -stiffness * (motion.position() - anchor))
    results = flexframe.Simulation(flexframe.Body(scene), [spring]).run()
    deflection = results["position"][:, 0] - anchor[0]
    total = results["energy/kinetic"] + 0.5 * stiffness * deflection**2
    assert deflection[-1] / deflection[0] == pytest.approx(after_a_period, rel=1e-12)
    assert total[-1] / total[0] == pytest.approx(energy, rel=1e-12)
    assert total[-1] / total[0] == pytest.approx(1.0, abs=1e-9)

    spinning = flexframe.Scene({**RIGID, "initial": {"angular_velocity": [0.0, 0.0, 2.0]}})
    thrust = flexframe.Force("center", lambda motion: [3.0, 0.0, 0.0], frame="body")
    thrown = flexframe.Simulation(flexframe.Body(spinning), [thrust]).run()
    assert thrown["position"][-1, 0] == pytest.approx(circled, rel=1e-12)
    assert circled == pytest.approx(closed, rel=1e-9)


# Conserved: the same motion as by the load of a scene.
def test_a_law_at_a_point_is_the_load_of_a_scene(ring):
    force = 200.0 * np.array([0.0, -1.0, 0.5]) / np.linalg.norm([0.0, -1.0, 0.5])
    half_sine = lambda motion: force * (np.sin(np.pi * motion.time / 0.002) if motion.time < 0.002 else 0.0)
    bare = flexframe.Body(flexframe.Scene({**RING, "loads": []}, base=EXAMPLES))
    by_law = flexframe.Simulation(bare, [flexframe.Force("struck", half_sine, discontinuities=[0.002])]).run()
    by_scene = flexframe.Simulation(ring).run()
    for path in ("position", "attitude", "modal/displacement", "energy/work", "points/velocity"):
        scale = np.abs(by_scene[path]).max()
        assert np.abs(by_law[path] - by_scene[path]).max() < 1e-10 * scale, path


# Conserved: the balance of energy.
def test_modal_forces_and_large_deflection_close_the_balance_of_energy():
    scene = flexframe.Scene(EXAMPLES / "thrown_plate.toml").with_values(
        {"time.end": 0.02, "output": {"interval": 1e-3, "points": {"tip": [-500.0, 0.0, 0.0]}}}
    )
    body = flexframe.Body(scene)

    def law(motion):
        assert motion.modal_velocity.shape == motion.modal_displacement.shape == body.frequencies.shape
        return np.where(np.arange(len(body.frequencies)) == 1, 5e3 * np.sin(300.0 * motion.time), 0.0)

    loads = [flexframe.ModalForce(law), flexframe.Force("tip", lambda motion: -2e-4 * motion.velocity(), name="drag")]
    results = flexframe.Simulation(body, loads).run()
    energy, balance = results["energy/kinetic"] + results["energy/strain"], results["energy/balance"]
    assert np.abs(results["energy/work"]).max() > 1e-3 * energy.max()
    assert np.abs(balance - balance[0]).max() < 1e-6 * energy.max()


# Conserved: the numbers of the rows.
def test_a_law_sees_the_motion_that_the_rows_have(ring):
    seen = {}

    def law(motion):
        seen[motion.time] = (motion.position("other"), motion.velocity("struck"), motion.origin, motion.rotation,
                             motion.angular_velocity, motion.modal_displacement)
        return np.zeros(3)

    results = flexframe.Simulation(ring, [flexframe.Force("struck", law)]).run()
    for row in (10, len(results["time"]) - 1):
        position, velocity, origin, rotation, omega, q = seen[results["time"][row]]
        w, *e = results["attitude"][row]
        turned = lambda v: v + 2 * w * np.cross(e, v) + 2 * np.cross(e, np.cross(e, v))
        expected = ring.points["other"] + results["points/other/displacement"][row]
        assert np.abs(position - expected).max() < 1e-9 * np.abs(expected).max()
        assert np.abs(velocity - results["points/struck/velocity"][row]).max() < 1e-9 * np.abs(velocity).max()
        assert np.abs(origin - results["origin"][row]).max() < 1e-12 * np.abs(origin).max()
        assert np.abs(rotation @ [1.0, 2.0, 3.0] - turned(np.array([1.0, 2.0, 3.0]))).max() < 1e-12
        assert np.array_equal(omega, results["angular_velocity"][row])
        assert np.array_equal(q, results["modal/displacement"][row])


# Closed form: F t²/(2m).
def test_what_is_left_to_the_program_is_on_with_a_law(rigid):
    """Nothing moves this body but the law, so that no estimate calls for its motion."""
    push = flexframe.Force("corner", lambda motion: [3.0, 0.0, 0.0])
    results = flexframe.Simulation(rigid, [push]).run()
    assert results["position"][-1, 0] == pytest.approx(0.5 * 3.0 / 2.0, rel=1e-9)
    assert np.abs(results["angular_velocity"][-1]).max() > 0.1
    fixed = flexframe.Body(rigid.scene.with_values({"effects.translation": False, "effects.rotation": False}))
    assert flexframe.Simulation(fixed, [push]).run()["position"][-1, 0] == 0.0


# Closed form: a damped oscillator.
def test_a_mode_that_a_law_has_struck_decays_as_its_damping_says():
    """e^(-zeta omega t) cos(omega sqrt(1 - zeta^2) t + phase), of a body that nothing moves but the law."""
    zeta, duration = 0.05, 1e-3
    still = {key: value for key, value in RING.items() if key not in ("initial", "loads")}
    modes = {"flexible": 4, "damping_ratio": zeta, "static_correction": False}
    body = flexframe.Body(flexframe.Scene({**still, "modes": modes}, base=EXAMPLES))
    assert np.array_equal(body.damping_ratios, np.zeros(4))  # by the scene alone

    def strike(motion):
        force = np.sin(np.pi * motion.time / duration) if motion.time < duration else 0.0
        return [force, 0.0, 0.0, 0.0]

    results = flexframe.Simulation(body, [flexframe.ModalForce(strike, discontinuities=[duration])]).run()
    assert np.array_equal(results.damping_ratios, np.full(4, zeta))
    free = results["time"] > 1.05 * duration
    t = results["time"][free] - results["time"][free][0]
    q, rate = results["modal/displacement"][free, 0], results["modal/velocity"][free, 0]
    omega = 2 * np.pi * body.frequencies[0]
    damped = omega * np.sqrt(1 - zeta**2)
    phase = damped * t
    expected = np.exp(-zeta * omega * t) * (q[0] * np.cos(phase) + (rate[0] + zeta * omega * q[0]) / damped * np.sin(phase))
    assert zeta * omega * t[-1] > 0.3
    assert np.abs(q - expected).max() < 1e-8 * np.abs(q).max()


# Closed form: g t²/2.
def test_gravity_acts_beside_a_force_that_outweighs_it_and_where_a_law_takes_the_force_away():
    loads = [
        {"kind": "gravity", "direction": [0.0, 0.0, -1.0], "amplitude": 1e-3},
        {"kind": "force", "at": [0.0, 0.0, 0.0], "direction": [1.0, 0.0, 0.0], "amplitude": 10.0},
    ]
    body = flexframe.Body(flexframe.Scene({**RIGID, "loads": loads}))
    assert flexframe.Simulation(body).run()["position"][-1, 2] == pytest.approx(-0.5 * 1e-3, rel=1e-9)
    against = flexframe.Force("center", lambda motion: [-10.0, 0.0, 0.0])
    position = flexframe.Simulation(body, [against]).run()["position"][-1]
    assert position[2] == pytest.approx(-0.5 * 1e-3, rel=1e-9)
    assert abs(position[0]) < 1e-9


# Conserved: the same rows, bit for bit.
def test_a_law_that_raised_may_be_mended_and_the_run_goes_on(rigid):
    broken = [False]

    def law(motion):
        if broken[0] and motion.time > 0.5:
            raise LookupError("the table of the actuator has no such time")
        return [1.0, np.sin(motion.time), 0.0]

    whole = flexframe.Simulation(rigid, [flexframe.Force("corner", law)]).run()
    broken[0] = True
    simulation = flexframe.Simulation(rigid, [flexframe.Force("corner", law)])
    with pytest.raises(LookupError, match="table of the actuator") as raised:
        simulation.run()
    assert 0.49 < simulation.time <= 0.5
    before = raised.value.results
    assert not before.complete and len(before["time"]) == 6
    assert np.array_equal(before["position"], whole["position"][:6])
    assert any("in the load `law` at time 0.5" in note for note in getattr(raised.value, "__notes__", ["in the load `law` at time 0.5"]))
    broken[0] = False
    after = simulation.run()
    assert np.array_equal(after["position"], whole["position"][6:])
    assert np.array_equal(after["energy/balance"], whole["energy/balance"][6:])


def test_a_row_where_a_drive_jumps_comes_after_a_law_that_raised_there():
    jump = {"amplitude": 0.5, "history": {"kind": "step", "at": 0.1}}
    hinge = {"kind": "hinge", "at": [0.0, 0.0, 0.0], "axis": [0.0, 0.0, 1.0], "motion": jump}
    body = flexframe.Body(flexframe.Scene({**RIGID, "constraints": [hinge]}))
    asked, fails_at = [0], [None]

    def law(motion):
        asked[0] += 1
        if asked[0] == fails_at[0]:
            raise LookupError("the table of the actuator has no such time")
        return [0.0, 0.0, 0.0]

    simulation = flexframe.Simulation(body, [flexframe.Force("corner", law)])
    simulation.advance()
    fails_at[0], asked[0] = asked[0], 0
    simulation = flexframe.Simulation(body, [flexframe.Force("corner", law)])
    with pytest.raises(LookupError):
        simulation.advance()
    assert simulation.time == simulation.advance().time == pytest.approx(0.1, rel=1e-12)


# Closed form: √(2h/g).
def test_a_body_bounces_at_an_event():
    """A corner falls to a plane, and is thrown back: closed forms, as in examples/bounce.rs."""
    height, gravity = 1.5, 9.81
    loads = [{"kind": "gravity", "direction": [0.0, 0.0, -1.0], "amplitude": gravity}]
    scene = flexframe.Scene({**RIGID, "loads": loads, "time": {"end": 3.0, "step": 0.01}})
    simulation = flexframe.Simulation(flexframe.Body(scene))
    simulation.add_event("on the plane", lambda row: row["points/corner/displacement"][2] + height, crossing="falling")
    simulation.add_event("at rest", lambda row: row["velocity"][2], crossing="falling")
    times = {}
    while not simulation.done:
        reached = simulation.advance()
        if reached.event == "on the plane":
            times[reached.event] = reached.time
            simulation.set_state({"velocity": -simulation.state()["velocity"]})
        elif reached.event == "at rest":
            times[reached.event] = reached.time
            break
    fall = np.sqrt(2 * height / gravity)
    assert times["on the plane"] == pytest.approx(fall, rel=1e-12)
    assert times["at rest"] == pytest.approx(2 * fall, rel=1e-12)


def test_a_run_passes_events_and_lists_them(ring):
    simulation = flexframe.Simulation(ring)
    simulation.add_event("struck point turns round", lambda row: row["points/struck/velocity"][1])
    results = simulation.run()
    assert results.events and all(name == "struck point turns round" for name, _ in results.events)
    velocity = results["points/struck/velocity"][:, 1]
    turns = np.sum(velocity[:-1] * velocity[1:] < 0)
    assert len(results.events) >= turns > 0


def test_the_gil_is_free_while_a_run_goes_on():
    """Another thread of Python counts while this one computes."""
    import threading

    scene = flexframe.Scene({**RIGID, "time": {"end": 1.0, "step": 2e-6}, "output": {"interval": 1.0}})
    simulation = flexframe.Simulation(flexframe.Body(scene))
    counted, stop = [0], threading.Event()

    def count():
        while not stop.wait(1e-4):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    simulation.advance()
    seen = counted[0]
    stop.set()
    thread.join()
    assert seen > 0
