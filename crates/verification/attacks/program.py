"""The program under attack, and what counts as a fault of it."""

import os
import resource
import signal
import subprocess
import time

# The exit codes that docs/reference/cli.md names.
CODES = {0, 2, 3, 4, 5, 6, 130}
MEMORY = 4 << 30


class Program:
    def __init__(self, path, folder):
        self.path, self.folder = os.path.abspath(path), folder
        self.temporary = os.path.join(folder, "temporary")
        os.makedirs(self.temporary, exist_ok=True)

    def environment(self):
        return {**os.environ, "FLEXFRAME_CACHE": "", "TMPDIR": self.temporary, "RAYON_NUM_THREADS": "1"}

    def start(self, arguments, folder=None):
        limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        return subprocess.Popen([self.path, *map(str, arguments)], cwd=folder or self.folder, env=self.environment(), preexec_fn=limit,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def run(self, arguments, folder=None, seconds=120):
        """Exit code, standard output, standard error; the code is None where the time was over."""
        child = self.start(arguments, folder)
        try:
            out, said = child.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            child.kill()
            out, said = child.communicate()
            return None, out.decode(errors="replace"), said.decode(errors="replace")
        return child.returncode, out.decode(errors="replace"), said.decode(errors="replace")


def fault(code, said):
    """A word for what must never be, or None."""
    if code is None:
        return "too long"
    if "panicked" in said or code == 101:
        return "panic"
    if code < 0:
        return f"ended by {signal.Signals(-code).name}"
    if code not in CODES:
        return f"exit code {code}"
    if code and "error: " not in said and not said.startswith('{"kind"'):
        return "failed without words"
    if "not enough memory" in said:
        return "memory"
    if "report this" in said:
        return "a bug by its own words"
    return None


class Count:
    """Trials of an attack by their outcomes, and its faults."""

    def __init__(self, name, what):
        self.name, self.what, self.outcomes, self.faults, self.started = name, what, {}, [], time.time()

    # Time that an attack may take.
    seconds = float("inf")

    def seeds(self, first, trials):
        """Numbers of the trials, as many as the time allows."""
        started = time.time()
        for seed in range(first, first + trials):
            if time.time() - started > Count.seconds:
                return
            yield seed

    def add(self, outcome, fault=None, case=None):
        self.outcomes[outcome] = self.outcomes.get(outcome, 0) + 1
        if fault:
            self.faults.append((case, fault))
            print(f"{self.name}: {case}: {fault}", flush=True)

    @property
    def trials(self):
        return sum(self.outcomes.values())

    def __str__(self):
        return f"{self.name}: {self.trials} in {time.time() - self.started:.0f} s: {self.outcomes}, {len(self.faults)} faults"
