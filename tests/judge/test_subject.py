"""A command as a subject: read to its end, ended with all that it started."""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.judge.bench.recorder import Recorder
from autograder.judge.subject import MAX_OUTPUT, CannotStart, CommandSubject

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.evidence import Part


def _part(work: Callable[[CommandSubject, Recorder], None], program: str) -> Part:
    """Run a program as a subject in a process of its own, as the judge does: it kills all its children.

    What the program has sent is taken in when its end is known, and not before.
    """
    queue: multiprocessing.SimpleQueue[Part] = multiprocessing.get_context("fork").SimpleQueue()

    def judge() -> None:
        recorder = Recorder()
        recorder.take_in = lambda: recorder.record("message", "/sent")
        subject = CommandSubject([sys.executable, "-u", "-c", program])
        subject.begin(1)
        subject.start(recorder, (), {})
        work(subject, recorder)
        queue.put(recorder.part())
        os._exit(0)

    process = multiprocessing.get_context("fork").Process(target=judge)
    process.start()
    part = queue.get()
    process.join()
    return part


def _await_end(subject: CommandSubject, recorder: Recorder) -> None:
    assert recorder.wait(lambda: subject.ended, 60.0)
    subject.stop()


def _await_ready_then_stop(subject: CommandSubject, recorder: Recorder) -> None:
    assert recorder.wait(lambda: recorder.part().said() != [], 60.0)
    subject.stop()


def _await_ready_then_press_ctrl_c(subject: CommandSubject, recorder: Recorder) -> None:
    assert recorder.wait(lambda: recorder.part().said() != [], 60.0)
    subject.interrupt()
    _await_end(subject, recorder)


def test_what_ends_on_ctrl_c_has_ended_by_itself() -> None:
    # in steps, because Python may note a signal just before a long wait begins, and raise only after the wait
    waits = "import time\ntry:\n    print('ready')\n    while True: time.sleep(0.01)\n"
    program = f"{waits}except KeyboardInterrupt:\n    print('bye')"
    part = _part(_await_ready_then_press_ctrl_c, program)
    assert part.said() == ["ready", "bye"]
    assert part.ending is not None
    assert (part.ending.name, part.ending.data["code"]) == ("exited", 0)


def test_all_that_it_printed_is_there_before_its_end() -> None:
    part = _part(_await_end, "import sys; print('out'); print('err', file=sys.stderr); sys.exit(3)")
    assert sorted(part.said()) == ["err", "out"]
    assert part.ending is not None
    assert part.events[-1] == part.ending
    assert part.events[-2].kind == "message"  # what it sent is there, too
    assert part.ending.data["code"] == 3


def test_a_traceback_is_found_and_is_nothing_that_it_said() -> None:
    part = _part(_await_end, "print('before')\nraise ValueError('Goal was canceled')")
    assert part.traceback.endswith("ValueError: Goal was canceled")
    assert part.said() == ["before"]


def test_a_syntax_error_is_found() -> None:
    assert "SyntaxError" in _part(_await_end, "def f(:").traceback


def test_the_stack_of_a_crash_in_compiled_code_is_a_traceback() -> None:
    program = "import ctypes\nprint('before')\ndef crash():\n    ctypes.string_at(0)\ncrash()"
    part = _part(_await_end, program)
    first, outermost, *_, last = part.traceback.splitlines()
    assert (first, last) == ("Traceback (most recent call last):", "Segmentation fault")
    assert outermost == '  File "<string>", line 5, in <module>'
    assert [line for line in part.said() if line] == ["before"]


def test_endless_output_is_cut_and_the_program_ended() -> None:
    part = _part(_await_ready_then_stop, "while True: print('x' * 1000)")
    assert sum(len(line) for line in part.said()) <= MAX_OUTPUT


def test_one_that_ignores_ctrl_c_is_killed() -> None:
    part = _part(
        _await_ready_then_stop,
        "import os, signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print(os.getpid()); time.sleep(600)",
    )
    assert not Path(f"/proc/{part.said()[0]}").exists()


def test_a_daemon_that_it_left_behind_is_killed() -> None:
    program = """
import os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        print(os.getpid(), flush=True)
        time.sleep(600)
    os._exit(0)
time.sleep(600)
"""
    part = _part(_await_ready_then_stop, program)
    deadline = time.monotonic() + 180
    while Path(f"/proc/{part.said()[0]}").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not Path(f"/proc/{part.said()[0]}").exists()


def test_a_hung_program_says_where_and_does_not_count_as_ended() -> None:
    stack: list[str] = []

    def ask(subject: CommandSubject, recorder: Recorder) -> None:
        recorder.wait(lambda: recorder.part().said() != [], 60.0)
        stack.append(subject.stack())
        recorder.record("stack", "subject", text=stack[0])
        subject.stop()

    part = _part(ask, "import time\ndef stuck():\n    print('there')\n    time.sleep(600)\nstuck()")
    assert "in stuck" in str(part.of("stack")[0].data["text"])
    assert part.ending is None
    assert part.said() == ["there"]


def test_a_program_that_another_one_has_started_says_where_it_hangs() -> None:
    hung = "import time\ndef wait_in_vain():\n    print('ready')\n    time.sleep(600)\nwait_in_vain()"
    program = (
        f"import subprocess, sys, time\nsubprocess.Popen([sys.executable, '-u', '-c', {hung!r}])\n"
        "def wait_beside():\n    time.sleep(600)\nwait_beside()"
    )

    def ask_then_stop(subject: CommandSubject, recorder: Recorder) -> None:
        assert recorder.wait(lambda: recorder.part().said() != [], 60.0)
        recorder.record("stack", "subject", text=subject.stack())
        subject.stop()

    (event,) = _part(ask_then_stop, program).of("stack")
    of_the_program, of_the_command = event.data["text"].split("Fatal Python error: Aborted")[1:]
    assert "wait_in_vain" in of_the_program
    assert "wait_beside" in of_the_command  # behind it, and neither in lines of the other's


def test_a_command_that_does_not_exist_is_named() -> None:
    subject = CommandSubject(["no-such-program"])
    subject.begin(1)
    with pytest.raises(CannotStart, match="no-such-program"):
        subject.start(Recorder(), (), {})


def test_the_processes_that_a_command_started_are_known() -> None:
    program = (
        "import subprocess, sys\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        "print(child.pid)\n"
        "child.wait()"
    )

    def look(subject: CommandSubject, recorder: Recorder) -> None:
        assert recorder.wait(lambda: recorder.part().said() != [], 60.0)
        recorder.record("output", "found", text=",".join(map(str, subject.processes())))
        subject.stop()

    started, found = _part(look, program).said()
    assert found == started
