#!/usr/bin/env python3
"""What each command answers on the examples, against the answers that are kept beside this file.

    golden.py PROGRAM [--accept] [--quick] [--elsewhere] [--only NAME]

`answers/SCENE.json` holds for each command its exit code, its report (`--json`) or its error, its words, and each column of its rows.
Of long lists it holds the largest number and the root mean square. Paths and what the machine took are left out. Numbers agree to a
part of the largest in their list. `--accept` writes the answers that are found; `--quick` takes scenes of a second only; `--elsewhere`
leaves out what another processor rounds in its own way, such as counts of steps and errors near rounding.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = Path(__file__).resolve().parent / "answers"
LONGEST = 9  # numbers of a list that are kept one by one
MOST = 4  # entries of a list of reports that are kept
# Keys whose values are of the machine, or are a matter of sign or of the choice among equal shapes.
MACHINE = re.compile(r"second|spent|elapsed|memory|bytes|cache|^times?$|^work$|^shape$|^files?$|^results$")
ROUNDING = re.compile(r"step|reject|evaluation|balance|error|residual|turned|moved|growth|open|forgotten|drift|left|change|within|beside|parts|relative")
SMALL = 2e-4
TAKEN = re.compile(r"[\d.]+ ?(s|ms|µs|min|h|MB|kB|bytes)\b|\d+ steps/s")
NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])")
SUPPORTED = ("modes", "advise", "campbell", "gradient")
MOVED = (*SUPPORTED, "linearize", "frf")
# One scene shows the commands that want a table or write files for others.
ALL = (*MOVED, "psd", "shock", "srs", "fit", "reduce", "sweep")
INPUT = "loads[0].traction"
TABLES = {
    "spectra.csv": f"frequency,{INPUT}\n10,1\n2000,1\n",
    "shock.csv": "0,0\n0.001,1\n0.002,0\n",
    "test.csv": "frequency,deviation\n230,1\n445,1\n",
    "sweep.toml": f'scene = "{ROOT}/examples/first-hour/pulled_rod.toml"\n[parameters]\n"modes.damping_ratio" = [0.1, 0.7]\n'
    '[results]\nmiddle = { final = "points/middle/displacement" }\n',
}
# The scene, speeds of a Campbell diagram, frequencies, commands beside `run`, `check` and the rows, and whether it is quick.
SCENES = {
    "clamp": ("examples/bar/clamp.toml", "0:50:3", "1:200:5", SUPPORTED, True),
    "free": ("examples/bar/free.toml", "0:50:3", "1:200:5", SUPPORTED, False),
    "hinge_bar": ("examples/bar/hinge.toml", "0:50:3", "1:200:5", SUPPORTED, False),
    "pin": ("examples/bar/pin.toml", "0:50:3", "1:200:5", SUPPORTED, False),
    "slider": ("examples/bar/slider.toml", "0:50:3", "1:200:5", SUPPORTED, False),
    "boom": ("examples/boom.toml", "0:5:3", "1:20:5", MOVED, True),
    "heavy_top": ("examples/heavy_top.toml", "0:50:3", "1:20:5", MOVED, False),
    "pendulum": ("examples/pendulum.toml", "0:50:3", "1:200:5", ("modes", "advise"), True),
    "rotating_bar": ("examples/rotating_bar.toml", "0:20:3", "1:200:5", SUPPORTED, False),
    "spin_up": ("examples/spin_up.toml", "0:6:3", "1:20:5", MOVED, False),
    "wu_haug": ("examples/wu_haug.toml", "0:6:3", "1:20:5", MOVED, False),
    "effects": ("examples/effects/full.toml", "0:50:3", "1:200:5", ("modes", "advise", "campbell"), False),
    "rigid": ("examples/effects/rigid.toml", "0:50:3", "1:200:5", ("modes", "advise"), False),
    "spinning_disc": ("examples/spinning_disc.toml", "0:100:3", "1:200:5", SUPPORTED, False),
    "tumbling": ("examples/accuracy/tumbling.toml", "0:50:3", "1:200:5", ("modes", "advise", "campbell"), False),
    "pair": ("examples/pair.toml", "0:50:3", "1:200:5", MOVED, True),
    "engine": ("examples/first-hour/engine.toml", "0:50:3", "1:200:5", MOVED, False),
    "pulled_rod": ("examples/first-hour/pulled_rod.toml", "0:50:3", "1:200:5", ALL, False),
    "deployment": ("examples/mechanisms/deployment.toml", "", "1:20:5", ("modes", "advise", "linearize", "frf"), False),
    "double_pendulum": ("examples/mechanisms/double_pendulum.toml", "0:5:3", "1:20:5", MOVED, False),
    "four_bar": ("examples/mechanisms/four_bar.toml", "0:5:3", "1:20:5", MOVED, True),
    "hinge": ("examples/mechanisms/hinge.toml", "0:5:3", "1:20:5", MOVED, False),
    "robot_arm": ("examples/mechanisms/robot_arm.toml", "0:5:3", "1:20:5", MOVED, False),
    "rotor_blade": ("examples/mechanisms/rotor_blade.toml", "0:60:4", "1:20:5", MOVED, False),
    "slider_crank": ("examples/mechanisms/slider_crank.toml", "0:5:3", "1:20:5", MOVED, False),
    "bent_rod": ("tests/bent_rod.toml", "0:5:3", "1:20:5", MOVED, False),
    "chain": ("tests/chain.toml", "0:5:3", "1:20:5", MOVED, False),
    "small_inertia": ("tests/small_inertia.toml", "0:5:3", "1:20:5", MOVED, False),
    "tied": ("tests/tied.toml", "0:5:3", "1:20:5", MOVED, False),
    "two": ("tests/two.toml", "0:5:3", "1:20:5", MOVED, False),
}


def number(value):
    """A number of JSON or of a table; none of anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        return float(value)
    except ValueError:
        return None


def rounded(x):
    return float(f"{x:.8g}") if math.isfinite(x) else str(x)


def condensed(numbers):
    """A long list of numbers."""
    largest = max(map(abs, numbers), default=0.0)
    mean = math.sqrt(sum((x / largest) ** 2 for x in numbers) / len(numbers)) * largest if largest > 0.0 else 0.0
    return {"largest": rounded(largest), "rms": rounded(mean)}


def flat(value):
    return [number for part in value for number in flat(part)] if isinstance(value, list) else [value]


def digest(value, folder):
    """An answer without what is of the machine, with long lists condensed."""
    if isinstance(value, dict):
        return {key: digest(part, folder) for key, part in value.items() if not MACHINE.search(key)}
    if isinstance(value, list):
        numbers = flat(value)
        if len(numbers) > LONGEST and all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in numbers):
            return condensed(list(map(float, numbers)))
        kept = [digest(part, folder) for part in value[:MOST]]
        return kept if len(value) <= MOST else [*kept, f"{len(value)} in all"]
    if isinstance(value, float):
        return rounded(value)
    return words(value, folder) if isinstance(value, str) else value


def words(text, folder):
    """Text without folders of this run and what the machine took."""
    return TAKEN.sub("(taken)", text.replace(f"{folder}/", ""))


def columns(path):
    """Each column of a table: of numbers condensed, of words counted."""
    heading, *rows = [line.split(",") for line in path.read_text().splitlines()]
    found = {}
    for name, *cells in zip(heading, *rows):
        numbers = [number(cell) for cell in cells]
        found[name] = f"{len(cells)} words" if None in numbers else condensed(numbers)
    return found


def answers(program, name, folder):
    """What the commands answer on a scene."""
    scene, speeds, frequencies, commands, _ = SCENES[name]
    environment = {**os.environ, "FLEXFRAME_CACHE": str(folder / "cache"), "NO_COLOR": "1"}

    def call(*arguments):
        return subprocess.run(
            [program, *arguments], cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True
        )

    def answer(*arguments):
        done = call(*arguments, "--json")
        if done.returncode != 0:
            return {"exit_code": done.returncode, "error": digest(json.loads((done.stderr.splitlines() or ["null"])[-1]), folder)}
        return {"exit_code": 0, "report": digest(json.loads(done.stdout or "null"), folder)}

    found = {"run": answer("run", scene, "-o", str(folder / "run"))}
    for file in sorted((folder / "run").glob("*.h5")):
        table = folder / "rows.csv"
        call("export", str(file), "--csv", str(table))
        found["rows"] = columns(table)
        found["check"] = answer("check", str(file))
    options = {
        "modes": ["-o", str(folder / "modes")],
        "advise": [],
        "campbell": ["--axis", "z", "--speeds", speeds, "-o", str(folder / "campbell")],
        "gradient": ["-o", str(folder / "gradient")],
        "linearize": ["-o", str(folder / "linear.mat")],
        "frf": ["--frequencies", frequencies, "-o", str(folder / "frf")],
        "psd": ["--spectra", str(folder / "spectra.csv"), "-o", str(folder / "psd")],
        "shock": ["--table", str(folder / "shock.csv"), "--input", INPUT],
        "srs": ["--frequencies", frequencies, "-o", str(folder / "srs")],
        "fit": ["--measured", str(folder / "test.csv"), "--parameters", "body.material.young_modulus"],
        "reduce": ["-o", str(folder / "body.h5")],
        "sweep": ["-o", str(folder / "sweep.h5")],
    }
    files = {"srs": str(folder / "shock.csv"), "sweep": str(folder / "sweep.toml")}
    for file, text in TABLES.items():
        (folder / file).write_text(text)
    for command in commands:
        arguments = [command, files.get(command, scene), *options[command]]
        found[command] = answer(*arguments)
        if found[command]["exit_code"] == 0:
            text = call(*arguments, *(["--overwrite"] if "-o" in arguments else [])).stdout
            lines = [line for line in words(text, folder).splitlines() if "(taken)" not in line]
            found[command]["words"] = lines[: 2 * LONGEST]
    return found


def differences(path, kept, found, elsewhere, scale=0.0):
    """The places at which two answers differ."""
    tolerance = 1e-3 if elsewhere else 1e-6
    if elsewhere and ROUNDING.search(path):
        return
    if isinstance(kept, dict) and isinstance(found, dict):
        scale = max((abs(x) for x in map(number, kept.values()) if x is not None), default=0.0) if "rms" in kept else 0.0
        for key in {**kept, **found}:
            yield from differences(f"{path}.{key}", kept.get(key), found.get(key), elsewhere, scale)
    elif isinstance(kept, list) and isinstance(found, list) and len(kept) == len(found):
        scale = max((abs(x) for x in kept if isinstance(x, float)), default=0.0)
        for k, (a, b) in enumerate(zip(kept, found)):
            yield from differences(f"{path}[{k}]", a, b, elsewhere, scale)
    elif isinstance(kept, float) and isinstance(found, (int, float)):
        largest = max(abs(kept), abs(found))
        is_rounding = largest < 1e-6 * scale or elsewhere and largest < SMALL
        if abs(kept - found) > tolerance * max(largest, scale) and not is_rounding:
            yield path, kept, found
    elif isinstance(kept, str) and isinstance(found, str):
        if NUMBER.sub("#", kept) != NUMBER.sub("#", found):
            yield path, kept, found
    elif kept != found:
        yield path, kept, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--accept", action="store_true")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--elsewhere", action="store_true")
    given = parser.parse_args()
    names = [name for name, scene in SCENES.items() if given.only in name and (scene[-1] or not given.quick)]

    def one(name):
        with tempfile.TemporaryDirectory() as folder:
            return answers(given.program.resolve(), name, Path(folder))

    count = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, found in zip(names, pool.map(one, names)):
            file = KEPT / f"{name}.json"
            if given.accept:
                lines = [f"{json.dumps(command)}: {json.dumps(answer, ensure_ascii=False)}" for command, answer in found.items()]
                file.write_text("{\n" + ",\n".join(lines) + "\n}\n")
                continue
            kept = json.loads(file.read_text())
            for path, before, now in differences(name, kept, found, given.elsewhere):
                print(f"{path}: {before!r} is kept, {now!r} is found")
                count += 1
    print(f"golden: {count} differences in {len(names)} scenes" if not given.accept else f"golden: {len(names)} written")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
