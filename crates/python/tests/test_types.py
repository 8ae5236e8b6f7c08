"""The type stubs say what is there."""

import os
import subprocess
import sys


def test_stubs_are_those_of_the_module(tmp_path):
    command = [sys.executable, "-m", "mypy.stubtest", "flexframe"]
    environment = {**os.environ, "MYPY_CACHE_DIR": str(tmp_path)}
    said = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert said.returncode == 0, said.stdout + said.stderr
