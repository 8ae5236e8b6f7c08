"""Reports of commands are those of the program."""

import json

import numpy as np
import pytest

import flexframe

from conftest import EXAMPLES

ROD = EXAMPLES / "first-hour" / "pulled_rod.toml"
BAR = EXAMPLES / "rotating_bar.toml"


@pytest.fixture
def shock_table(tmp_path):
    table = tmp_path / "shock.csv"
    table.write_text("0,0\n0.001,1\n0.002,0\n")
    return table


@pytest.fixture
def said(program, tmp_path):
    def told(*arguments):
        return json.loads(program(*arguments, "--json", cwd=tmp_path).stdout)

    return told


@pytest.mark.filterwarnings("ignore:.*is a program")
def test_a_frequency_response_is_that_of_the_program(said, tmp_path):
    found = flexframe.frf(flexframe.Scene(ROD), (1, 500, 20), outputs=["middle.displacement"])
    expected = said("frf", ROD, "--frequencies", "1:500:20", "--outputs", "middle.displacement")
    assert found["peaks"] == expected["peaks"]
    table = found.table("frf")
    rows = np.genfromtxt(tmp_path / "out/pulled_rod/frf.csv", delimiter=",", skip_header=1)
    assert np.array_equal(np.column_stack(list(table.values())), rows)
    assert found.table("peaks")["output"] == [peak["output"] for peak in expected["peaks"]]
    assert "highest responses" in str(found) and found.svg().startswith("<svg")
    files = found.save(tmp_path / "saved")
    assert {file.name for file in files} == {"frf.csv", "frf.html", "frf.svg", "frf.pdf", "frf.png"}
    assert list(found.to_pandas("peaks")["input"]) == ["loads[0].traction"] * 3


@pytest.mark.filterwarnings("ignore:.*is a program")
def test_answers_to_tables_are_those_of_the_program(said, tmp_path, shock_table):
    scene = flexframe.Scene(ROD)
    spectra = tmp_path / "spectra.csv"
    spectra.write_text("frequency,loads[0].traction\n10,1\n2000,1\n")
    assert flexframe.psd(scene, spectra)["outputs"] == said("psd", ROD, "--spectra", spectra)["outputs"]
    found = flexframe.shock(scene, shock_table, "loads[0].traction")
    assert found["modes"] == said("shock", ROD, "--table", shock_table, "--input", "loads[0].traction")["modes"]
    # It writes no files and draws nothing.
    assert found.svg() is None and found.save(tmp_path / "none") == []
    spectrum = flexframe.srs(shock_table, (10, 1000, 5), damping_ratios=[0.02, 0.1])
    expected = said("srs", shock_table, "--frequencies", "10:1000:5", "--damping", "0.02,0.1")
    assert spectrum["spectra"] == expected["spectra"]


def test_a_diagram_is_that_of_the_program(said):
    found = flexframe.campbell(flexframe.Scene(BAR), (0, 600, 4), axis=[0, 0, 1], orders=[3])
    expected = said("campbell", BAR, "--axis", "z", "--speeds", "0:600:4", "--orders", "3")
    assert found["critical_speeds"] == expected["critical_speeds"] and found["branches"] == expected["branches"]
    assert found.tables == ["critical_speeds", "campbell"]


def test_wrong_arguments_are_refused(shock_table):
    with pytest.raises(flexframe.InputError, match="the axis of the spin"):
        flexframe.campbell(flexframe.Scene(BAR), (0, 600, 4))
    with pytest.raises(flexframe.InputError, match="linear or monotone-cubic"):
        flexframe.srs(shock_table, (10, 1000, 5), interpolation="round")
    with pytest.raises(KeyError, match="nothing"):
        flexframe.srs(shock_table, (10, 1000, 5)).table("nothing")
    with pytest.raises(KeyError):
        flexframe.srs(shock_table, (10, 1000, 5))["peaks[0]"]
