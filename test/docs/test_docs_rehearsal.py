"""The rehearsal of a takeover in docs/standby.md. It takes a minute, so only `make test-all` runs it."""

import os
import re
import subprocess

import pytest


@pytest.mark.skipif(os.environ.get("ROAH_TEST_ALL") != "yes", reason="takes a minute: only in make test-all")
def test_the_rehearsal_of_a_takeover(tmp_path):
    done = subprocess.run(["rosrun", "roah_rsbb", "standby", "rehearse"], capture_output=True, text=True, timeout=600,
                          env={**os.environ, "TMPDIR": str(tmp_path)})
    assert done.returncode == 0, done.stderr
    steps = [re.sub(r"^ *[0-9.]+ s  ", "", line) for line in done.stdout.splitlines()]
    assert "The robot is connected to it" in steps
    assert steps[-1].startswith("This box is superseded: the box at 127.0.0.22 has taken over")
    assert list(tmp_path.iterdir()) == [], "nothing is left"
