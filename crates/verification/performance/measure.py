"""Runs a program as a whole process: wall time, processor time, peak memory, output.

The process that imports this has to stay small (no NumPy): on Linux a new process begins with the peak memory of the
one that starts it.
"""

import os
import platform
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

HERE = Path(__file__).parent
FLEXFRAME = os.environ.get("FLEXFRAME", "target/release/flexframe")
PYTHON = ".tools/performance/bin/python"
PYTHON_OF_SLEPC = ".tools/performance-slepc/bin/python"


class Run:
    """Time and memory of a process. `output` is None where it was stopped after `patience` seconds."""

    def __init__(self, command, patience=None, threads=1, folder=None, **environment):
        command = [str(word) for word in command]
        with tempfile.TemporaryFile() as errors:
            begin = time.perf_counter()
            process = subprocess.Popen(
                command,
                stdout=subprocess.PIPE,
                stderr=errors,
                cwd=folder,
                env=os.environ | common_environment(threads) | environment,
            )
            stopped = threading.Event()
            timer = threading.Timer(patience or 1e6, lambda: (stopped.set(), process.terminate()))
            timer.daemon = True
            timer.start()
            output = process.stdout.read().decode()
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            self.seconds = time.perf_counter() - begin
            self.processor = usage.ru_utime + usage.ru_stime
            self.memory = 1024 * usage.ru_maxrss
            self.output = None if stopped.is_set() else output
            if process.returncode != 0 and not stopped.is_set():
                errors.seek(0)
                words = (output[-2000:] + errors.read().decode(errors="replace")[-2000:]).strip()
                sys.exit(f"performance: `{' '.join(command)}` failed:\n{words}")

    def record(self, **more):
        return {"seconds": self.seconds, "processor": self.processor, "memory": self.memory} | more


def flexframe(*arguments, threads=1, cache=""):
    """A run of flexframe that prints JSON; without a cache, unless a folder is given."""
    return Run([FLEXFRAME, "--threads", threads, *arguments, "--json"], threads=threads, FLEXFRAME_CACHE=str(cache))


def common_environment(threads):
    of_threads = {f"{name}_NUM_THREADS": str(threads) for name in ("OMP", "OPENBLAS", "RAYON")}
    return of_threads | openblas_kernels() | debian_slepc()


def of_processor(key):
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next((line.split(":")[1].strip() for line in lines if line.startswith(key)), "")


def openblas_kernels():
    """The OpenBLAS kernels for this processor, as environment.

    Debian's OpenBLAS 0.3.21 does not know processors younger than itself and then falls back to SSE3
    ("Prescott") without a word, which costs CHOLMOD half of its speed.
    """
    flags = set(of_processor("flags").split())
    if {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"} <= flags:
        return {"OPENBLAS_CORETYPE": "SkylakeX"}
    if {"avx2", "fma"} <= flags:
        return {"OPENBLAS_CORETYPE": "Haswell"}
    return {}


def debian_slepc():
    """Where slepc4py finds its libraries: without PETSc's headers Debian makes no link at the usual place."""
    folders = {name: sorted(Path(f"/usr/lib/{name}dir").glob(f"{name}*/*-real")) for name in ("petsc", "slepc")}
    return {f"{name.upper()}_DIR": str(found[-1]) for name, found in folders.items() if found}


def machine():
    """The machine of the measurement."""
    memory = next(line for line in Path("/proc/meminfo").read_text().splitlines() if line.startswith("MemTotal"))
    return {
        "processor": of_processor("model name") or platform.machine(),
        "cores": os.cpu_count(),
        "memory": 1024 * int(memory.split()[1]),
        "system": debian() or platform.system(),
        "openblas_kernels": openblas_kernels().get("OPENBLAS_CORETYPE", "its own choice"),
    }


def debian():
    release = Path("/etc/os-release")
    lines = release.read_text().splitlines() if release.exists() else []
    return next((line.split("=")[1].strip('"') for line in lines if line.startswith("PRETTY_NAME")), "")


def versions():
    """Versions of the peers, by name."""
    packages = [line.split()[0].split("==") for line in (HERE / "requirements.txt").read_text().splitlines()]
    of_debian = {
        "SLEPc": "libslepc-real3.18",
        "PETSc": "libpetsc-real3.18",
        "MUMPS": "libmumps-5.5",
        "SuiteSparse": "libsuitesparse-dev",
        "OpenBLAS": "libopenblas0-pthread",
        "CalculiX": "calculix-ccx",
        "gmsh": "gmsh",
    }
    found = {"Python": platform.python_version()} | dict(packages)
    for name, package in of_debian.items():
        query = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True)
        found[name] = query.stdout or "not of Debian"
    return found
