"""A program in a fork says and does what it says and does in a process of its own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from autograder.judge.serving.fork import Child
from autograder.judge.subjects.command_subject import CommandSubject

if TYPE_CHECKING:
    from pathlib import Path

PROGRAMS = {
    "arguments and output": "import sys\nprint(sys.argv[1:], __name__)\nprint('é', file=sys.stderr)",
    "no end of line": "print('half a line', end='')",
    "an exit code": "import sys\nsys.exit(3)",
    "an exit with words": "import sys\nsys.exit('not there')",
    "an error": "def work():\n    return {}['key']\n\nwork()",
    "a syntax error": "print('fine'\nx = 1",
    "a missing module": "import my_robot_pkg_that_is_nowhere",
    "its own folder comes first": "import sys, os\nprint(sys.path[0] == os.path.dirname(os.path.abspath(__file__)))",
    "nothing of the judge": "import sys\nprint([name for name in sys.modules if name.startswith('autograder')])",
    "environment": "import os\nprint(os.environ['ROS_DOMAIN_ID'], os.environ.get('PYTEST_VERSION'))",
    "threads end first": "import threading\nthreading.Timer(0.1, print, ['last']).start()\nprint('first')",
    "what is left for the end": "import atexit\natexit.register(print, 'at exit')\nprint('before')",
    "killed": "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)",
    "interrupted": "import os, signal\nos.kill(os.getpid(), signal.SIGINT)",
    "a session of its own": "import os\nprint(os.getsid(0) == os.getpid())",
}


def warmly(file: Path, environment: dict[str, str]) -> bytes:
    from autograder.authoring.warm_python import WarmPython

    CommandSubject([])  # makes this process the one that gets the orphans
    program = WarmPython().run([str(file), "1", "-2"], environment, None)
    out, errors = program.stdout.read(), program.stderr.read()
    return json.dumps([program.wait(), out.decode(), errors.decode()]).encode()


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_fork_is_as_good_as_a_process(name: str, tmp_path: Path) -> None:
    file = tmp_path / "program.py"
    file.write_text(PROGRAMS[name], encoding="utf-8")
    kept = ("PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "HOME")
    environment = {k: v for k, v in os.environ.items() if k in kept} | {"ROS_DOMAIN_ID": "7"}
    seen: Any = subprocess.run(
        [sys.executable, str(file), "1", "-2"],
        env=environment,
        capture_output=True,
        text=True,
        start_new_session=True,
    )
    data = Child(lambda: warmly(file, environment), 20.0).result().data
    assert data is not None
    code, out, errors = json.loads(data)
    assert (out, errors) == (seen.stdout, seen.stderr)
    # An interrupted interpreter kills itself by the signal; whether it does is no concern of a judge.
    assert code == seen.returncode or seen.returncode == -signal.SIGINT


def test_a_program_that_is_interrupted_at_its_very_end_does_not_go_on_as_the_process_it_was_forked_from(
    tmp_path: Path,
) -> None:
    file = tmp_path / "program.py"
    file.write_text(
        "import atexit\n\ndef end():\n    raise KeyboardInterrupt\n\natexit._run_exitfuncs = end\n"
    )
    gone_on = tmp_path / "gone on"

    def judge() -> bytes:
        judging = os.getpid()
        try:
            return warmly(file, {"PATH": os.environ["PATH"]})
        finally:
            if os.getpid() != judging:
                gone_on.touch()

    assert Child(judge, 20.0).result().data is not None
    assert not gone_on.exists()
