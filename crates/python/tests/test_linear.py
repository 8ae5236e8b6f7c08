"""Linear models in Python: matrices with names, python-control, refusals."""

import flexframe
import numpy as np
import pytest

CHAIN = {
    "title": "pendulum",
    "units": {"length": "m", "mass": "kg", "time": "s"},
    "bodies": {
        "bob": {
            "rigid": {"mass": 2.0, "center_of_mass": [0, 0, 0], "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
            "markers": {"pin": {"at": [0, 0, 0]}},
            "points": {"rim": [1, 0, 0]},
        }
    },
    "joints": [
        {
            "name": "pin",
            "kind": "revolute",
            "between": ["ground", "bob.pin"],
            "axis": [0, 0, 1],
            "spring": {"stiffness": 9.0, "damping": 0.6},
        }
    ],
    "time": {"end": 1.0, "tolerance": 1e-6},
}


def test_a_sprung_turn_is_its_closed_form():
    # Closed form: J a" + d a' + k a = m.
    model = flexframe.linearize(flexframe.Scene(CHAIN))
    expected = np.roots([1, 0.6, 9])
    np.testing.assert_allclose(sorted(model.poles, key=lambda z: z.imag), sorted(expected, key=lambda z: z.imag), rtol=1e-9)
    assert [channel.name for channel in model.inputs] == ["pin.turn"]
    names = [channel.name for channel in model.outputs]
    turn, rim = names.index("pin.turn"), names.index("rim.acceleration.y")
    s = 0.7j
    response = model.C @ np.linalg.solve(s * np.eye(2) - model.A, model.B) + model.D
    np.testing.assert_allclose(response[turn, 0], 1 / (s * s + 0.6 * s + 9), rtol=1e-9)
    np.testing.assert_allclose(response[rim, 0], s * s / (s * s + 0.6 * s + 9), rtol=1e-9)
    assert model.outputs[turn].unit == "rad" and model.time == 0.0 and model.error_bound is None


def test_python_control_has_the_same_system():
    control = pytest.importorskip("control")
    model = flexframe.linearize(flexframe.Scene(CHAIN), outputs=["pin.turn"])
    system = model.to_control()
    assert isinstance(system, control.StateSpace)
    np.testing.assert_allclose(control.dcgain(system)[0, 0], 1 / 9, rtol=1e-9)
    assert system.input_labels == ["pin_turn"] and system.output_labels[0] == "pin_turn"


def test_what_is_not_there_is_refused():
    scene = flexframe.Scene(CHAIN)
    with pytest.raises(flexframe.InputError, match="no input `push`"):
        flexframe.linearize(scene, inputs=["push"])
    with pytest.raises(flexframe.InputError, match="balanced:N or modal:N"):
        flexframe.linearize(scene, reduce="krylov:2")
    with pytest.raises(flexframe.RefusedError, match="order 9"):
        flexframe.linearize(scene, reduce="modal:9")
