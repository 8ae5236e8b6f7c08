"""Disks with too little room: the old file or the new one, and nothing half-written. Needs the right to mount a tmpfs."""

import os
import random
import shutil
import subprocess

from program import Count, fault
import forged

# Outputs by command; each begins as the word "old".
COMMANDS = [(["run", "bar.toml", "--no-check", "-o", "DISK"], "bar.h5"), (["reduce", "bar.toml", "-o", "DISK/b.h5"], "b.h5"),
            (["reduce", "bar.toml", "-o", "DISK/b.op4"], "b.op4"), (["reduce", "bar.toml", "-o", "DISK/b.glb"], "b.glb"),
            (["report", "bar.h5", "-o", "DISK/r.html"], "r.html"), (["export", "bar.h5", "--vtkhdf", "DISK/x.vtkhdf"], "x.vtkhdf"),
            (["export", "bar.h5", "--csv", "DISK"], "bar.csv"), (["animate", "bar.h5", "-o", "DISK/a.gif"], "a.gif"),
            (["frf", "bar.toml", "--frequencies", "1:9:200", "-o", "DISK"], "frf.csv"), (["linearize", "bar.toml", "-o", "DISK/l.mat"], "l.mat"),
            (["modes", "bar.toml", "--solver", "slepc", "--ranks", "1", "--write-only", "DISK"], "K.petsc"),
            (["new", "bar.msh", "-o", "DISK/n.toml"], "n.toml")]


def attack(program, trials, first=0):
    count = Count("disks", "outputs of twelve commands onto a disk (tmpfs) with 0 to 400 kB of room, over old files: the old file or the new one, nothing half-written, "
                  "the exit code 6")
    folder, disk = os.path.join(program.folder, "disks"), os.path.join(program.folder, "disk")
    forged.seeds(program, folder)
    os.makedirs(disk, exist_ok=True)
    new = {}
    for command, name in COMMANDS:
        program.run([word.replace("DISK", disk) for word in command] + ["--overwrite"], folder)
        with open(os.path.join(disk, name), "rb") as file:
            new[name] = file.read()
    shutil.rmtree(disk)
    os.makedirs(disk)
    for seed in count.seeds(first, trials):
        rng = random.Random(seed)
        command, name = rng.choice(COMMANDS)
        room = rng.choice([0, 4, 16, 64, 100, 200, 400]) * 1024 + rng.randrange(4096)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={2 << 20}", "none", disk]).returncode:
            count.add("no right to mount")
            break
        try:
            old = os.path.join(disk, name)
            with open(old, "w") as file:
                file.write("old")
            with open(os.path.join(disk, "fill"), "wb") as file:
                file.write(bytes(max(0, (2 << 20) - room - 8192)))
            code, _, said = program.run([word.replace("DISK", disk) for word in command] + ["--overwrite"], folder, 60)
            wrong = fault(code, said)
            names = sorted(os.listdir(disk))
            content = open(old, "rb").read()
            if not wrong and code not in (0, 6):
                wrong = f"exit code {code}: {said[-200:]}"
            # Of several outputs those that found room may be new.
            if not wrong and code and content not in (b"old", new[name]):
                wrong = f"{name} was lost by {command[0]}"
            stray = [name for name in names if name.startswith(".flexframe-")]
            wrong = wrong or (f"left {stray}" if stray else None)
            count.add("written" if code == 0 else "refused", wrong, f"{seed} {command[0]} {name}")
        finally:
            subprocess.run(["umount", disk], check=True)
    shutil.rmtree(disk, ignore_errors=True)
    return count
