from __future__ import annotations

import subprocess
import sys

import pytest

DAEMON = """
import os, subprocess, sys
from autograder.boxes.process_ends import end_descendants
from autograder.parent_death import adopt_orphans
adopt_orphans()
# The usual way into the background: a child in a session of its own whose parent ends.
middle = subprocess.Popen([sys.executable, "-c", '''
import os, subprocess
p = subprocess.Popen(["sleep", "600"], start_new_session=True)
print(p.pid, flush=True)
'''], stdout=subprocess.PIPE)
daemon = int(middle.stdout.readline())
middle.wait()
print(end_descendants())
try:
    os.kill(daemon, 0)
    print("alive")
except ProcessLookupError:
    print("gone")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux adopts orphans")
def test_a_daemon_does_not_outlive_the_submission() -> None:
    result = subprocess.run(
        [sys.executable, "-c", DAEMON], capture_output=True, text=True, timeout=180, check=True
    )
    assert result.stdout.split() == ["1", "gone"]
