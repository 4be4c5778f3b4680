"""Wrong arguments raise errors, and nothing else: in a process of its own, with a limit of memory."""
from __future__ import annotations

import os
import pathlib
import subprocess
import sys

import pytest

FULL = bool(os.environ.get("DARTCAST_FULL"))


@pytest.mark.parametrize("seed", [1, 3, 4] + (list(range(5, 15)) if FULL else []))
def test_only_errors_come_of_wrong_arguments(seed: int) -> None:
    program = pathlib.Path(__file__).parent / "wrong_kinds.py"
    rounds = "100" if FULL else "10"
    done = subprocess.run([sys.executable, str(program), rounds, str(seed)], capture_output=True, text=True, check=False,
                          timeout=3000 if FULL else 300)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[0]) > 700 * int(rounds)
