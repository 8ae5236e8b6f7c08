"""Random systems by the program against the reference: counts of what is right, refused and wrong in silence.

Usage: measure.py PROGRAM FOLDER [--systems N] [--first SEED] [--jobs N] [--again SEED,SEED] [--references] [--kept] [--page PAGE]
FOLDER keeps the reference of each system (`reference/SEED.json`), and what the program made of it (`runs-HASH/SEED.json`, by the content of the
program). With --references only the former are made; --kept counts what is there. What is there is not made again, so that an interrupted measurement goes on. With --page the table goes between its marks in PAGE.
"""

import argparse
import collections
import hashlib
import json
import math
import multiprocessing
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import h5py
import numpy as np

import generate
import reference

# A run that takes longer than this of the processor is a failure of its own; beside others it may take longer by the clock.
SECONDS = 5
BY_THE_CLOCK = 120
VERDICTS = ["right", "right as the motion magnifies", "impossible, refused", "near a lock, refused", "told", "refused without a true reason",
            "too slow", "wrong in silence", "crash", "reference unsure"]


def write(path, value):
    part = path.with_suffix(f".{os.getpid()}.part")
    part.write_text(json.dumps(value))
    part.rename(path)


def run_reference(system, start, close):
    """States at the outputs, with its own error."""
    ref = reference.Reference(system)
    times = np.linspace(0, system["end"], 5)
    point = [b["point"] for b in system["bodies"]]
    out = {"states": None, "why": "", "error": None}
    try:
        if close:
            start, off = ref.close(0.0, start)
            if off > 1e-10 * system["size"]:
                raise reference.Unsure("the start does not close")
        fine = ref.run(start, times, 1e-11, most=8000)
        coarse = ref.run(start, times, 1e-8)
        off = max(reference.distance(fine, coarse, ref.n, system["size"], point))
        # The fine run is some hundred times as exact as what it differs from the coarse one by.
        if off > 3 * system["tolerance"]:
            raise reference.Unsure("two tolerances differ")
        out.update(states=fine.tolist(), error=off)
    except reference.Unsure as unsure:
        out["why"] = str(unsure)
    except np.linalg.LinAlgError as error:
        out["why"] = f"linear algebra: {error}"
    out.update(least=ref.least, dropped=ref.dropped, rank=ref.rank, rows=ref.rows)
    return out


def magnified(system, start):
    """By how much small errors of places, attitudes, velocities and spins at the start have grown at the end, and of the last two on the way."""
    ref, rng, grown = reference.Reference(system), np.random.default_rng(1), 1.0
    n, size, point = ref.n, system["size"], [b["point"] for b in system["bodies"]]
    times = np.linspace(0, system["end"], 5)
    by = 1e-6
    try:
        base = ref.run(start, times, 1e-9, most=20000)
        for _ in range(2):
            other = start.copy()
            other[: 3 * n] += by * size * rng.normal(size=3 * n)
            q = other[3 * n : 7 * n].reshape(n, 4)
            other[3 * n : 7 * n] = reference.product(reference.small_turn(by * rng.normal(size=(n, 3))), q).ravel()
            speed = max(1.0 / system["end"], np.abs(start[7 * n : 13 * n]).max())
            other[7 * n : 10 * n] += by * size * speed * rng.normal(size=3 * n)
            other[10 * n : 13 * n] += by * speed * rng.normal(size=3 * n)
            other, _ = ref.close(0.0, other)
            grown = max(grown, max(reference.distance(ref.run(other, times, 1e-9, most=20000), base, n, size, point)) / by)
    except (reference.Unsure, np.linalg.LinAlgError):
        return math.inf
    return grown


def read_rows(path, system):
    """States of the results file without what the scene puts on them; spins global."""
    _, metre, _, _, _, second = generate.UNITS[system["units"]]
    far, fast = np.array(system["far"]), np.array(system["fast"])
    rows = []
    with h5py.File(path) as file:
        time = np.array(file["time"]) * second
        names = [b["name"] for b in system["bodies"]]
        one = lambda b, key: np.array(file[f"bodies/{b}/{key}"])
        x = [one(b, "position") * metre - far - np.outer(time, fast) for b in names]
        q = [one(b, "attitude") for b in names]
        v = [one(b, "velocity") * metre / second - fast for b in names]
        w = [np.einsum("tij,tj->ti", reference.rotation(p), one(b, "angular_velocity") / second) for b, p in zip(names, q)]
    for k in range(len(time)):
        rows.append(np.concatenate([np.ravel([one[k] for one in lot]) for lot in (x, q, v, w)]))
    return time, rows


def judge(program, folder, seed):
    """What the program makes of one system."""
    system = generate.system(seed)
    text, starts = generate.scene(system)
    out = {"seed": seed, "class": system["class"], "detail": system["detail"], "bodies": len(system["bodies"]), "tolerance": system["tolerance"],
           "far": float(np.linalg.norm(system["far"])), "fast": float(np.linalg.norm(system["fast"])), "thrown": system["thrown"], "turned": system["turned"]}
    impossible = system["class"] == "impossible"
    moved = system["thrown"] or system["turned"]
    n, size = len(system["bodies"]), system["size"]
    ref = reference.Reference(system)
    point = [b["point"] for b in system["bodies"]]
    kept = folder / "reference" / f"{seed}.json"
    truth = None
    if not impossible and not moved:
        start = ref.start(system["bodies"])
        if kept.exists():
            truth = json.loads(kept.read_text())
        else:
            truth = run_reference(system, start, True)
            write(kept, truth)
        out.update(least=truth["least"])
        if truth["states"] is None:
            return {**out, "verdict": "reference unsure", "message": truth["why"]}
    with tempfile.TemporaryDirectory() as work:
        path = Path(work) / "scene.toml"
        path.write_text(text)
        words = ["nice", program, "run", str(path), "-o", work, "--no-check", "--json"]
        begun = time.monotonic()
        try:
            environment = {**os.environ, "FLEXFRAME_CACHE": "", "RAYON_NUM_THREADS": "1"}
            limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
            done = subprocess.run(words, capture_output=True, text=True, timeout=BY_THE_CLOCK, env=environment, preexec_fn=limit)
        except subprocess.TimeoutExpired:
            return {**out, "verdict": "too slow", "message": f"more than {BY_THE_CLOCK} s by the clock"}
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return {**out, "verdict": "too slow", "message": f"more than {SECONDS} s of the processor"}
        out["seconds"] = time.monotonic() - begun
        said = {}
        for line in (done.stdout.strip(), *done.stderr.strip().splitlines()[::-1]):
            try:
                said = json.loads(line)
                break
            except ValueError:
                continue
        if done.returncode != 0:
            out.update(code=done.returncode, message=said.get("message", done.stderr[-500:]).replace(work, ""))
            if done.returncode not in (1, 2, 3, 4, 5) or "panicked" in done.stderr:
                return {**out, "verdict": "crash"}
            if impossible:
                return {**out, "verdict": "impossible, refused"}
            if truth and truth["least"] < 3e-3:
                return {**out, "verdict": "near a lock, refused"}
            if moved and not truth:
                # Is there a place and a motion next to the start at all, and is it determined?
                bodies = [{**b, "place": x, "attitude": q} for b, (x, q) in zip(system["bodies"], starts)]
                truth = run_reference(system, ref.start(bodies), True)
                if truth["states"] is None:
                    return {**out, "verdict": "reference unsure", "message": truth["why"]}
            return {**out, "verdict": "refused without a true reason"}
        out["warnings"] = [w[:300] for w in said.get("warnings", [])]
        lines = [line for line in said["trust"]["lines"] if line["place"] == "steps"]
        out["card"] = max((line["error"] for line in lines if line["error"] is not None), default=None)
        out["steps"] = said.get("steps")
        found = [f for f in Path(work).glob("*.h5") if ".part" not in f.name]
        times, rows = read_rows(found[0], system)
    if impossible:
        return {**out, "verdict": "told" if out["warnings"] else "wrong in silence"}
    turns = np.array([])
    if moved:
        # The start is what the program closed it to, if it satisfies all rows and is near the start that was given.
        r = np.concatenate((reference.rotation(rows[0][3 * n : 7 * n].reshape(n, 4)), np.eye(3)[None]))
        turns = np.array([ref.turn(system["joints"][k], r) for k in ref.counted])
        start = np.concatenate((rows[0], turns))
        off, rate = ref.residual(0.0, start)
        out.update(start_off=off / size, start_rate=rate / size)
        given = np.concatenate((np.ravel([s[0] for s in starts]), np.ravel([s[1] for s in starts])))
        out["start_moved"] = max(reference.distance([given], [rows[0]], n, size, point))
        drives = [j for j in system["joints"] if j.get("drive") and j["along"] == "turn"]
        wrong = max((abs(math.remainder(ref.turn(j, r) - reference.drive_values(j["drive"], 0.0)[0], 2 * math.pi)) for j in drives), default=0.0)
        allowed = 1e-7 + 1e-15 * out["far"] / size
        if off > allowed * size or wrong > 1e-6 or (system["thrown"] and not system["turned"] and out["start_moved"] > 100 * system["thrown"]):
            return {**out, "verdict": "told" if out["warnings"] else "wrong in silence", "message": f"the start does not close: {off / size:.1e}, drives {wrong:.1e}, moved {out['start_moved']:.1e}"}
        key = hashlib.sha256(np.round(start, 9).tobytes()).hexdigest()[:16]
        kept = folder / "reference" / f"{seed}-{key}.json"
        if kept.exists():
            truth = json.loads(kept.read_text())
        else:
            truth = run_reference(system, start, True)
            write(kept, truth)
        out.update(least=truth["least"])
        if truth["states"] is None:
            return {**out, "verdict": "reference unsure", "message": truth["why"]}
    states = np.array(truth["states"])
    place, turn = reference.distance(rows, states, n, size, point)
    error = max(place, turn)
    # Rounding of numbers far away is not the program's.
    floor = 16 * np.finfo(float).eps * (out["far"] + out["fast"] * system["end"]) / size
    out.update(place=place, attitude=turn, reference_error=truth["error"], floor=floor)
    if out["card"] is not None:
        out["over_card"] = (error - floor) / max(out["card"], 1e-300)
    if not math.isfinite(error):
        return {**out, "verdict": "wrong in silence", "message": "not a number"}
    if error <= 10 * system["tolerance"] + floor:
        return {**out, "verdict": "right"}
    out["magnified"] = magnified(system, states[0])
    if error <= 10 * system["tolerance"] * out["magnified"] + floor * out["magnified"] and math.isfinite(out["magnified"]):
        return {**out, "verdict": "right as the motion magnifies"}
    return {**out, "verdict": "told" if out["warnings"] else "wrong in silence"}


def one_reference(task):
    """The reference alone, of a system that starts where the scene says."""
    _, folder, _, seed = task
    system, path = generate.system(seed), folder / "reference" / f"{seed}.json"
    if system["class"] != "impossible" and not system["thrown"] and not system["turned"] and not path.exists():
        write(path, run_reference(system, reference.Reference(system).start(system["bodies"]), True))


def one(task):
    program, folder, runs, seed = task
    path = runs / f"{seed}.json"
    if path.exists():
        return json.loads(path.read_text())
    try:
        out = judge(program, folder, seed)
    except Exception as error:  # a fault of this script must be seen, and not stop the others
        return {"seed": seed, "class": "?", "verdict": "script", "message": repr(error)}
    write(path, out)
    return out


def reason(message):
    """A kind of message, without names and numbers."""
    return re.sub(r"[-+]?\d[\d.e+-]*", "N", re.sub(r'"[^"]*"', "…", message)).split(";")[0][:110]


def table(results):
    lines = ["| | " + " | ".join(VERDICTS) + " | all |", "|---|" + "---|" * (len(VERDICTS) + 1)]
    for name in [*generate.CLASSES, "all"]:
        lot = [r for r in results if name in ("all", r["class"])]
        count = collections.Counter(r["verdict"] for r in lot)
        lines.append(f"| {name} | " + " | ".join(str(count[v]) for v in VERDICTS) + f" | {len(lot)} |")
    return "\n".join(lines)


def main():
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("program")
    asked.add_argument("folder", type=Path)
    asked.add_argument("--systems", type=int, default=2000)
    asked.add_argument("--first", type=int, default=0)
    asked.add_argument("--jobs", type=int, default=2)
    asked.add_argument("--again", default="")
    asked.add_argument("--references", action="store_true")
    asked.add_argument("--kept", action="store_true")
    asked.add_argument("--page", type=Path)
    asked = asked.parse_args()
    content = hashlib.sha256(Path(asked.program).read_bytes()).hexdigest()[:10]
    runs = asked.folder / f"runs-{content}"
    runs.mkdir(parents=True, exist_ok=True)
    (asked.folder / "reference").mkdir(exist_ok=True)
    seeds = [int(path.stem) for path in runs.glob("*.json")] if asked.kept else [int(s) for s in asked.again.split(",") if s] or range(asked.first, asked.first + asked.systems)
    for seed in seeds if asked.again else []:
        (runs / f"{seed}.json").unlink(missing_ok=True)
    results = []
    tasks = [(asked.program, asked.folder, runs, seed) for seed in seeds]
    with multiprocessing.Pool(asked.jobs) as pool:
        if asked.references:
            pool.map(one_reference, tasks, chunksize=1)
            return
        for result in map(one, tasks) if asked.kept else pool.imap_unordered(one, tasks):
            results.append(result)
            if result["verdict"] not in ("right", "impossible, refused", "reference unsure"):
                print({key: result.get(key) for key in ("seed", "class", "verdict", "message", "place", "attitude", "tolerance", "magnified", "warnings", "far", "fast", "thrown") if result.get(key)}, flush=True)
    results.sort(key=lambda r: r["seed"])
    shown = table(results)
    for verdict in ("wrong in silence", "told", "too slow", "crash"):
        found = [str(r["seed"]) for r in results if r["verdict"] == verdict]
        shown += f"\n\n{verdict.capitalize()}: " + (f"seeds {', '.join(found)}." if found else "none.") if len(results) else ""
    print(shown)
    print()
    for verdict in ("impossible, refused", "near a lock, refused", "refused without a true reason", "reference unsure", "script"):
        for text, count in collections.Counter(reason(r.get("message", "")) for r in results if r["verdict"] == verdict).most_common():
            print(f"{verdict}: {count} × {text}")
    for verdict in ("refused without a true reason",):
        print(f"{verdict}: seeds {[r['seed'] for r in results if r['verdict'] == verdict]}")
    over = [r["over_card"] for r in results if "over_card" in r]
    if over:
        print(f"error over the card's share: median {np.median(over):.2g}, 95 % below {np.quantile(over, 0.95):.2g}, above 1 in {sum(o > 1 for o in over)} of {len(over)}, above 10 in {sum(o > 10 for o in over)}")
    if asked.page:
        page = asked.page.read_text()
        before, rest = page.split("<!-- random systems -->\n")
        after = rest.split("<!-- end of random systems -->")[1]
        asked.page.write_text(f"{before}<!-- random systems -->\n{shown}\n<!-- end of random systems -->{after}")


if __name__ == "__main__":
    main()
