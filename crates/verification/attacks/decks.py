"""Decks of Abaqus, Nastran and UNV, and meshes in MSH, with lines and fields changed."""

import os
import random
import shutil
import subprocess

from program import Count, fault

HERE = os.path.dirname(os.path.abspath(__file__))
WORDS = ["", "0", "-1", "1e400", "nan", "99999999999", "1.0", "*NODE", "GRID", "CTETRA", "-1", "    -1", "  2411", "*INCLUDE, INPUT=/etc/passwd", "INCLUDE '/etc/passwd'",
         "+", "$", "**", "ENDDATA", "*END PART", "*INSTANCE, NAME=a, PART=b", "\x00", "\u202e", "1-2", "1.0D0", "*ELEMENT, TYPE=C3D10", "RBE2", "RBE3", "CORD2R", "*TIE", "GRDSET"]


def seeds(folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    mesh = os.path.join(HERE, "../../model/tests/data/bar.msh")
    shutil.copy(mesh, os.path.join(folder, "bar.msh"))
    for ending in ["inp", "bdf", "unv"]:
        subprocess.run(["gmsh", "-v", "0", "-3", "-order", "2", "-setnumber", "Mesh.MeshSizeMin", "50", os.path.join(HERE, "../../model/tests/data/bar.geo"), "-o", f"bar.{ending}"], cwd=folder, check=True)
    return {name: open(os.path.join(folder, name), encoding="utf-8").read().split("\n") for name in ["bar.inp", "bar.bdf", "bar.unv", "bar.msh"]}


def change(rng, lines):
    lines = list(lines)
    for _ in range(rng.choice([1, 1, 2, 5, 30])):
        # Heads of sections are few among the lines of nodes.
        heads = [i for i, line in enumerate(lines) if not line[:1].isspace() and not line[:1].isdigit()] or [0]
        i = rng.choice(heads) if rng.random() < 0.4 else rng.randrange(len(lines))
        how = rng.randrange(7)
        if how == 0:
            del lines[i]
        elif how == 1:
            lines.insert(i, lines[rng.randrange(len(lines))])
        elif how == 2:
            fields = lines[i].replace(",", " , ").split(" ")
            fields[rng.randrange(len(fields))] = rng.choice(WORDS)
            lines[i] = " ".join(fields)
        elif how == 3:
            lines[i] = rng.choice(WORDS)
        elif how == 4:
            at = rng.randrange(len(lines[i]) + 1)
            lines[i] = lines[i][:at] + rng.choice(WORDS + ["\t", "é"]) + lines[i][at + 1:]
        elif how == 5:
            lines[i] = lines[i][: rng.randrange(len(lines[i]) + 1)]
        else:
            j = rng.randrange(len(lines))
            lines[i], lines[j] = lines[j], lines[i]
        lines = lines or [""]
    return lines


def attack(program, trials, first=0):
    count = Count("decks", "decks of Abaqus, Nastran and UNV and meshes in MSH with one to thirty lines or fields deleted, doubled, cut, swapped or replaced; read by `new`")
    folder = os.path.join(program.folder, "decks")
    sound = seeds(folder)
    for seed in count.seeds(first, trials):
        rng = random.Random(seed)
        name = rng.choice(list(sound))
        deck = f"deck.{name.split('.')[1]}"
        with open(os.path.join(folder, deck), "w", encoding="utf-8") as file:
            file.write("\n".join(change(rng, sound[name])))
        code, _, said = program.run(["new", deck, "-o", "scene.toml", "--overwrite"], folder, 60)
        wrong = fault(code, said) or ("shows a foreign file" if "root:" in said else None)
        count.add(f"{name[4:]} " + ("read" if code == 0 else "refused"), wrong, seed)
    return count
