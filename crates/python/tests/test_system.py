"""Systems of bodies in Python: a robot arm under controllers, events on joints, states."""

import math

import flexframe
import numpy as np
import pytest

LENGTH, MASS = 0.5, 4.0
INERTIA = MASS * LENGTH**2 / 12
GAINS = [(400.0, 40.0), (150.0, 12.0)]
TARGETS = [1.0, -0.7]
WEIGHT = {"kind": "gravity", "amplitude": 9.81, "direction": [0, -1, 0]}


def link(x, loads=(WEIGHT,)):
    inertia = [[1e-3, 0, 0], [0, INERTIA, 0], [0, 0, INERTIA]]
    return {
        "rigid": {"mass": MASS, "center_of_mass": [0, 0, 0], "inertia": inertia},
        "markers": {"root": {"at": [-LENGTH / 2, 0, 0]}, "tip": {"at": [LENGTH / 2, 0, 0]}},
        "initial": {"position": [x, 0, 0]},
        "points": {"hand": [LENGTH / 2, 0, 0]},
        "loads": list(loads),
    }


def arm(end=1.0, loads=(WEIGHT,)):
    return {
        "title": "arm",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "bodies": {"upper": link(LENGTH / 2, loads), "fore": link(1.5 * LENGTH, loads)},
        "joints": [
            {"name": "shoulder", "kind": "revolute", "between": ["ground", "upper.root"], "axis": [0, 0, 1]},
            {"name": "elbow", "kind": "revolute", "between": ["upper.tip", "fore.root"], "axis": [0, 0, 1]},
        ],
        "time": {"end": end, "tolerance": 1e-7},
        "output": {"interval": 0.05},
    }


def controller(number):
    proportional, derivative = GAINS[number]
    return lambda time, angle, rate: proportional * (TARGETS[number] - angle) - derivative * rate


def rates(state):
    """Lagrange's equations of the two links: angles against the horizontal, and their rates."""
    first, second, first_rate, second_rate = state
    shoulder = controller(0)(0, first, first_rate)
    elbow = controller(1)(0, second - first, second_rate - first_rate)
    square, weight, bend = MASS * LENGTH**2, MASS * 9.81 * LENGTH, second - first
    mass = np.array(
        [
            [INERTIA + 1.25 * square, 0.5 * square * math.cos(bend)],
            [0.5 * square * math.cos(bend), INERTIA + 0.25 * square],
        ]
    )
    right = [
        shoulder - elbow + 0.5 * square * math.sin(bend) * second_rate**2 - 1.5 * weight * math.cos(first),
        elbow - 0.5 * square * math.sin(bend) * first_rate**2 - 0.5 * weight * math.cos(second),
    ]
    return np.array([first_rate, second_rate, *np.linalg.solve(mass, right)])


# Independent reference: Lagrange's equations, in 4000 steps of RK4.
def test_an_arm_under_controllers_moves_by_lagranges_equations():
    system = flexframe.System(flexframe.Scene(arm()))
    assert (set(system.bodies), system.joints) == ({"upper", "fore"}, ["shoulder", "elbow"])
    forces = [flexframe.JointForce(name, controller(i)) for i, name in enumerate(system.joints)]
    results = flexframe.Simulation(system, joint_forces=forces).run()
    angles = np.column_stack([results[f"joints/{name}/angle"] for name in system.joints])
    assert angles.shape == (21, 2)
    state, h = np.zeros(4), 1 / 4000
    for k in range(4001):
        if k % 200 == 0:
            expected = [state[0], state[1] - state[0]]
            assert angles[k // 200] == pytest.approx(expected, abs=1e-5)
        one = rates(state)
        two = rates(state + h / 2 * one)
        three = rates(state + h / 2 * two)
        four = rates(state + h * three)
        state = state + h / 6 * (one + 2 * two + 2 * three + four)
    # The controllers' work is in the file.
    assert results["joints/elbow/torque"].shape == (21,)
    assert np.isfinite(results["joints/elbow/drive_power"]).all()


# Closed form: without weight and forces an arm that turns as a whole does so evenly.
def test_an_event_on_a_joint_and_a_state():
    simulation = flexframe.Simulation(flexframe.System(flexframe.Scene(arm(loads=()))))
    state = simulation.state()
    assert set(state) == {"upper", "fore"}
    for name, x in [("upper", LENGTH / 2), ("fore", 1.5 * LENGTH)]:
        state[name]["angular_velocity"] = np.array([0.0, 0.0, 2.0])
        state[name]["velocity"] = np.array([0.0, 2.0 * x, 0.0])
    simulation.set_state(state)
    simulation.add_event("half a radian", lambda row: row["joints/shoulder/angle"] - 0.5, crossing="rising")
    reached = simulation.advance_to(0.6)
    assert (reached.kind, reached.event) == ("event", "half a radian")
    assert reached.time == pytest.approx(0.25, abs=1e-7)
    reached = simulation.advance_to(0.63)
    assert (reached.kind, reached.time) == ("stop", 0.63)
    row = simulation.observe()
    assert row["joints/shoulder/rate"] == pytest.approx(2.0, abs=1e-6)
    hand = 2 * LENGTH * np.array([math.cos(1.26), math.sin(1.26), 0.0])
    assert row["bodies/fore/position"] == pytest.approx(hand * 0.75, abs=1e-6)
    rows = list(simulation)
    assert [round(row.time / 0.05) for row in rows] == list(range(13, 21))


# Closed form: 4/3 a + 1/2 b = 1/2 a + 1/3 b = 3 N l / (m l²) are the accelerations of straight links whose end is pushed across: the
# shoulder goes back.
def test_a_load_on_a_body_of_a_system_is_a_law():
    seen = []

    def push(motion):
        seen.append(motion.time)
        return [0.0, 3.0, 0.0]

    system = flexframe.System(flexframe.Scene(arm(end=0.1, loads=())))
    pushed = flexframe.Simulation(system, {"fore": [flexframe.Force("hand", push)]}).run()
    push_over_inertia = 3.0 / (MASS * LENGTH)
    first = push_over_inertia * (1 / 3 - 1 / 2) / (4 / 9 - 1 / 4)
    assert seen and pushed["joints/shoulder/angle"][-1] == pytest.approx(0.5 * first * 0.1**2, rel=1e-2)


def off_the_point(axis):
    def equation(position, rotation):
        return position[axis], np.eye(3)[axis]

    return equation


def off_the_axis(axis):
    def equation(position, rotation):
        return rotation[2, axis], np.zeros(3), np.cross(rotation[:, axis], [0, 0, 1])

    return equation


# Independent reference: the hinge of the scene.
def test_equations_of_a_joint_do_what_a_hinge_does():
    own = arm()
    own["joints"][1] = {"name": "elbow", "locked": [], "between": ["upper.tip", "fore.root"], "axis": [0, 0, 1]}
    equations = [off_the_point(axis) for axis in range(3)] + [off_the_axis(axis) for axis in range(2)]
    equations = [flexframe.JointEquation("elbow", equation) for equation in equations]
    found = flexframe.Simulation(flexframe.System(flexframe.Scene(own)), joint_equations=equations).run()
    expected = flexframe.Simulation(flexframe.System(flexframe.Scene(arm()))).run()
    assert np.ptp(expected["joints/elbow/angle"]) > 1.0
    for path in ["bodies/fore/position", "bodies/fore/angular_velocity"]:
        assert found[path] == pytest.approx(expected[path], abs=1e-5)
    # The reaction of the equations is that of the hinge.
    assert found["joints/elbow/force"] == pytest.approx(expected["joints/elbow/force"], abs=1e-3)


def test_equations_that_do_not_fit_are_refused():
    own = arm(end=0.2)
    own["joints"][1] = {"name": "elbow", "locked": [], "between": ["upper.tip", "fore.root"], "axis": [0, 0, 1]}
    system = flexframe.System(flexframe.Scene(own))

    def broken(position, rotation):
        raise ValueError("no wire")

    for equation, words in [
        (lambda position, rotation: (position[0], [0, 1, 0]), "by_position"),
        (lambda position, rotation: position[0], "a residual and its derivative"),
        (lambda position, rotation: (position[0], [1, 0]), "derivative by the position"),
        (broken, "no wire"),
    ]:
        with pytest.raises((flexframe.InputError, ValueError), match=words):
            flexframe.Simulation(system, joint_equations=[flexframe.JointEquation("elbow", equation)])
    with pytest.raises(flexframe.InputError, match="wrist"):
        flexframe.Simulation(system, joint_equations=[flexframe.JointEquation("wrist", off_the_point(0))])


def drifting(elements, end=1.0):
    """Two links that drift apart and tumble, with a spring or a bushing of the scene."""
    scene = arm(end=end, loads=()) | {"joints": []} | elements
    scene["time"] = {"end": end, "tolerance": 1e-8}
    scene["bodies"]["fore"]["initial"] |= {"velocity": [0.3, 0.4, 0], "angular_velocity": [0, 1.0, 2.0]}
    return flexframe.System(flexframe.Scene(scene))


SPRING = {"stiffness": 300.0, "damping": 4.0, "free_length": 0.1}
BUSHING = {"stiffness": {"translation": [200, 300, 400], "rotation": [10, 20, 30]}, "damping": {"translation": [1, 2, 3]}}
MARKERS = ["upper.tip", "fore.root"]


def along_the_line(time, motion):
    length = np.linalg.norm(motion.position)
    if length == 0:
        return np.zeros(3)
    along = motion.position / length
    rate = along @ motion.velocity
    return -along * (SPRING["stiffness"] * (length - SPRING["free_length"]) + SPRING["damping"] * rate)


def in_axes(time, motion):
    force = -np.array([200, 300, 400]) * motion.position - np.array([1, 2, 3]) * motion.velocity
    # The rotation vector of the turn of the second marker.
    axis = np.array([motion.rotation[2, 1], motion.rotation[0, 2], motion.rotation[1, 0]])
    axis = 0.5 * (axis - [motion.rotation[1, 2], motion.rotation[2, 0], motion.rotation[0, 1]])
    sine = np.linalg.norm(axis)
    angle = math.atan2(sine, 0.5 * (np.trace(motion.rotation) - 1))
    turn = axis * (angle / sine if sine > 0 else 1.0)
    moment = np.array([10, 20, 30]) * turn
    # Eq. (J22): the gradient of the energy, against an angular velocity in the axes of the first marker.
    factor = (1 - angle / 2 / math.tan(angle / 2)) / angle**2 if angle > 1e-4 else 1 / 12
    moment = moment + 0.5 * np.cross(turn, moment) + factor * np.cross(turn, np.cross(turn, moment))
    return force, -moment


# Independent reference: a spring and a bushing of the scene between the same markers.
@pytest.mark.parametrize(
    "law, elements",
    [
        (along_the_line, {"springs": [{"name": "tie", "between": MARKERS, **SPRING}]}),
        (in_axes, {"bushings": [{"name": "tie", "between": MARKERS, **BUSHING}]}),
    ],
)
def test_a_law_between_markers_does_what_an_element_of_the_scene_does(law, elements):
    own = flexframe.Simulation(drifting({}), marker_forces=[flexframe.MarkerForce(MARKERS, law)])
    found, expected = own.run(), flexframe.Simulation(drifting(elements)).run()
    for body in ["upper", "fore"]:
        for column, scale in [("position", 1.0), ("angular_velocity", 10.0)]:
            path = f"bodies/{body}/{column}"
            assert found[path] == pytest.approx(expected[path], abs=1e-5 * scale)
    # The forces of the scene's element are in its results: those that the law finds.
    if "springs" in elements:
        pull = SPRING["stiffness"] * (expected["joints/tie/length"] - SPRING["free_length"])
        pull += SPRING["damping"] * expected["joints/tie/length_rate"]
        # A spring of no length has no line, and pulls nowhere.
        pull[expected["joints/tie/length"] == 0] = 0
        assert expected["joints/tie/pull"] == pytest.approx(pull, abs=1e-9)
    else:
        assert np.ptp(expected["joints/tie/force_marker"], axis=0).max() > 0.1
        assert np.ptp(expected["joints/tie/moment"], axis=0).max() > 0.01
    # It moved, and momenta stayed.
    assert np.ptp(found["bodies/upper/position"], axis=0).max() > 0.05
    momentum = found["system/momentum/linear"]
    assert momentum == pytest.approx(np.tile(momentum[0], (len(momentum), 1)), abs=1e-10)


def test_a_law_between_markers_that_fails_ends_the_step():
    def broken(time, motion):
        if time > 0.3:
            raise ValueError("no rope")
        assert motion.rotation.shape == (3, 3) and motion.angular_velocity.shape == (3,)
        return [0.0, 0.0, 0.0]

    simulation = flexframe.Simulation(drifting({}), marker_forces=[flexframe.MarkerForce(MARKERS, broken)])
    with pytest.raises(ValueError, match="no rope"):
        simulation.run()
    for between, words in [(["upper.tip", "fore.hand"], "fore.root"), (["ground", "ground"], "two bodies")]:
        with pytest.raises(flexframe.InputError, match=words):
            flexframe.Simulation(drifting({}), marker_forces=[flexframe.MarkerForce(between, along_the_line)])
    for returned in [None, [1.0, 2.0], [[0, 0, 0], [0, 0, math.nan]]]:
        law = flexframe.MarkerForce(MARKERS, lambda time, motion, returned=returned: returned)
        with pytest.raises(flexframe.InputError, match="law"):
            flexframe.Simulation(drifting({}), marker_forces=[law]).run()


def test_what_does_not_fit_is_refused():
    system = flexframe.System(flexframe.Scene(arm()))
    for force, words in [
        (flexframe.JointForce("wrist", controller(0)), "wrist"),
        (flexframe.JointForce("elbow", controller(0), along="slide"), "revolute"),
    ]:
        with pytest.raises(flexframe.InputError, match=words):
            flexframe.Simulation(system, joint_forces=[force])
    with pytest.raises(flexframe.InputError, match="names of bodies"):
        flexframe.Simulation(system, [flexframe.Force("hand", lambda motion: [0, 0, 0])])
    with pytest.raises(flexframe.InputError, match="thigh"):
        flexframe.Simulation(system, {"thigh": []})
    with pytest.raises(ValueError, match="no torque"):

        def broken(time, angle, rate):
            if time > 0.3:
                raise ValueError("no torque")
            return 0.0

        flexframe.Simulation(system, joint_forces=[flexframe.JointForce("elbow", broken)]).run()


# Closed form: Ft²/2m.
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("force", [0.2, 1e-9])
def test_a_law_pushes_a_free_body_of_a_system_from_rest(tolerance, force):
    ball = {
        "rigid": {"mass": 0.2, "center_of_mass": [0, 0, 0], "inertia": [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]]},
        "points": {"center": [0, 0, 0]},
    }
    scene = {
        "title": "ball",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "bodies": {"ball": ball},
        "time": {"end": 3.0, "tolerance": tolerance},
        "output": {"interval": 3.0},
    }
    push = flexframe.Force("center", lambda motion: np.array([0.0, 0.0, force]))
    results = flexframe.Simulation(flexframe.System(flexframe.Scene(scene)), {"ball": [push]}).run()
    assert results["position"][-1, 2] == pytest.approx(0.5 * force * 9.0 / 0.2, rel=1e-9)


def bouncing(**told):
    """A ball that falls on a ground of 1e4 N/m, as a law between markers and as one along a slide, and the calls of each."""
    inertia = [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]
    scene = {
        "title": "ball",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "bodies": {
            "ball": {
                "rigid": {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": inertia},
                "markers": {"middle": {"at": [0, 0, 0]}},
                "loads": [WEIGHT | {"direction": [0, 0, -1]}],
            },
        },
        "ground": {"markers": {"floor": {"at": [0, 0, -0.5]}}},
        "time": {"end": 1.0, "tolerance": 1e-6, "scheme": "gauss"},
        "output": {"interval": 0.1},
    }
    calls = [0]

    def on_markers(time, motion):
        calls[0] += 1
        return [0.0, 0.0, 1e4 * max(-motion.position[2], 0.0)]

    def on_slide(time, path, rate):
        calls[0] += 1
        return 1e4 * max(-0.5 - path, 0.0)

    slide = {"name": "slide", "kind": "prismatic", "between": ["ground", "ball.middle"], "axis": [0, 0, 1]}
    markers = flexframe.MarkerForce(["ground.floor", "ball.middle"], on_markers, switch=told.get("gap"))
    along = flexframe.JointForce("slide", on_slide, switch=told.get("path"))
    for own, ties in [({"marker_forces": [markers]}, {}), ({"joint_forces": [along]}, {"joints": [slide]})]:
        calls[0] = 0
        simulation = flexframe.Simulation(flexframe.System(flexframe.Scene(scene | ties)), **own)
        results = simulation.run()
        height, speed = (results[column][:, 2] for column in ["position", "velocity"])
        energy = 0.5 * speed**2 + 9.81 * height + 0.5e4 * np.maximum(-0.5 - height, 0.0) ** 2
        yield energy / (9.81 * 0.5), calls[0]


# Conserved: the energy of the ball with its height and the ground.
def test_steps_end_at_the_kinks_that_laws_tell():
    silent = list(bouncing())
    told = list(bouncing(gap=lambda time, motion: motion.position[2], path=lambda time, path, rate: path + 0.5))
    for energy, _ in silent + told:
        assert np.abs(energy - energy[0]).max() < 1e-6
    for (_, before), (_, now) in zip(silent, told):
        assert now < 0.75 * before


def test_a_switch_that_is_none_is_told():
    for switch, words in [(1.0, "a switch is a function"), ([0.0], "found list")]:
        with pytest.raises(TypeError, match=words):
            flexframe.JointForce("slide", lambda time, path, rate: 0.0, switch=switch)

    def late(value):
        return lambda time, motion: 1.0 if time < 0.1 else value()

    for value, error, words in [
        (lambda: math.nan, flexframe.InputError, "the switch of the law `on_markers`: found NaN"),
        (lambda: None, flexframe.InputError, "the switch of the law `on_markers`: found None"),
        (lambda: 1 / 0, ZeroDivisionError, "division"),
    ]:
        with pytest.raises(error, match=words) as raised:
            next(bouncing(gap=late(value)))
        assert any("in the switch of the law `on_markers`" in note for note in raised.value.__notes__)
