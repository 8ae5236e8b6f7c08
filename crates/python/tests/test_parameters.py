"""Rates and fits in Python: arrays, the program's numbers, refusals."""

import json

import flexframe
import numpy as np
import pytest
from conftest import EXAMPLES, RING

# Held at one side, pushed at the other.
HELD = {
    **RING,
    "initial": {},
    "constraints": [{"kind": "clamp", "at": [0.0, -100.0, 10.0], "radius": 30.0}],
    "modes": {"flexible": 4, "damping_ratio": 0.01},
}
E, RHO = "body.material.young_modulus", "body.material.density"


@pytest.fixture(scope="module")
def scene():
    return flexframe.Scene(HELD, base=EXAMPLES)


@pytest.fixture(scope="module")
def found(scene):
    return flexframe.gradient(scene, [E, RHO, "thickness.z"], frequencies=(0.0, 100.0, 3))


def test_rates_are_their_closed_forms(found):
    # Closed form: f goes with the root of E/rho, a static displacement with 1/E.
    np.testing.assert_allclose(found.rates[E].relative, 0.5, rtol=1e-9)
    np.testing.assert_allclose(found.rates[RHO].frequencies, -0.5 * found.frequencies / found.values[RHO], rtol=1e-9)
    key = ("loads[0]", "struck")
    u = found.statics[key]
    rate = found.rates[E].statics[key]
    assert rate is not None and np.linalg.norm(u) > 0
    np.testing.assert_allclose(rate * found.values[E], -u, rtol=1e-6)
    assert found.effective_masses.shape == (4, 3) and found.rates[RHO].effective_masses.shape == (4, 3)
    # Closed form: the masses go with the density.
    np.testing.assert_allclose(found.rates[RHO].effective_masses * found.values[RHO], found.effective_masses, rtol=1e-6, atol=1e-12)


def test_responses_are_complex_with_rates(found):
    key = ("struck.displacement.y", "loads[0]")
    h, rate = found.responses[key], found.rates[E].responses[key]
    assert found.response_frequencies.tolist() == [0.0, 50.0, 100.0] and h.shape == (3,) and np.iscomplexobj(h)
    # Closed form: at frequency 0 a sum of modes goes with 1/E.
    np.testing.assert_allclose(rate[0] * found.values[E], -h[0], rtol=1e-6)


def test_they_are_the_numbers_of_the_program(found, program, tmp_path):
    text = "\n".join(
        [
            'title = "Ring"\nunits = { length = "mm", mass = "Mg", time = "s" }',
            f'[body]\nmesh = "{(EXAMPLES.parent / "meshes/ring.msh").as_posix()}"',
            "material = { young_modulus = 210000.0, poisson_ratio = 0.3, density = 7.85e-9 }",
            '[[constraints]]\nkind = "clamp"\nat = [0.0, -100.0, 10.0]\nradius = 30.0',
            "[modes]\nflexible = 4\n[time]\nend = 0.01\nstep = 2e-5",
        ]
    )
    (tmp_path / "ring.toml").write_text(text)
    said = program("gradient", "ring.toml", "--parameters", "thickness.z", "--json", cwd=tmp_path)
    assert said.returncode == 0, said.stderr
    rates = json.loads(said.stdout)["parameters"][0]["frequencies"]
    np.testing.assert_allclose(found.rates["thickness.z"].frequencies, rates, rtol=1e-9)


def test_a_fit_gives_back_what_made_the_frequencies(scene, tmp_path):
    other = flexframe.gradient(scene.with_values({E: 190000.0}), [E])
    fit = flexframe.fit(scene, [E], other.frequencies, deviation=0.01)
    parameter = fit.parameters[E]
    np.testing.assert_allclose([parameter.start, parameter.value], [210000.0, 190000.0], rtol=1e-8)
    # Closed form: of four frequencies that go with the root of E, each known to s, ln E has the deviation 2 s/sqrt(4).
    np.testing.assert_allclose(np.log(np.array(parameter.interval) / parameter.value), np.array([-1, 1]) * 1.959964 * 0.01, rtol=1e-5)
    assert fit.modes.tolist() == [0, 1, 2, 3] and fit.degrees_of_freedom == 3 and fit.deviations_stated
    np.testing.assert_allclose(fit.after, other.frequencies, rtol=1e-9)
    assert scene.with_values(fit.values)
    table = tmp_path / "test.csv"
    table.write_text("frequency\n" + "".join(f"{f!r}\n" for f in other.frequencies.tolist()))
    again = flexframe.fit(scene, [E], table)
    np.testing.assert_allclose(again.values[E], 190000.0, rtol=1e-8)
    assert not again.deviations_stated


def test_a_fitted_stretch_is_no_value_of_the_scene(scene, found):
    # Conserved: the frequencies of the mesh as it is leave it as it is.
    fit = flexframe.fit(scene, [E, "thickness.z"], found.frequencies)
    assert fit.parameters[E].is_key and not fit.parameters["thickness.z"].is_key
    np.testing.assert_allclose(fit.parameters["thickness.z"].value, 1.0, rtol=1e-6)
    assert list(fit.values) == [E] and scene.with_values(fit.values)


def test_what_is_not_there_is_refused(scene):
    with pytest.raises(flexframe.InputError, match="body.material.young_modulus"):
        flexframe.gradient(scene, ["body.material.colour"])
    with pytest.raises(flexframe.InputError, match="positive"):
        flexframe.fit(scene, [E], [100.0, -1.0])
    with pytest.raises(flexframe.InputError, match=r"shape \(2, 2\)") as refused:
        flexframe.fit(scene, [E], np.array([[100.0, 1.0], [200.0, 2.0]]))
    assert refused.value.key == "measured"
    with pytest.raises(flexframe.InputError, match="start:end:count"):
        flexframe.gradient(scene, [E], frequencies=(5.0, 1.0, 3))
    with pytest.raises(flexframe.RefusedError, match="apart"):
        flexframe.fit(scene, [E, RHO], [100.0, 200.0, 300.0])
