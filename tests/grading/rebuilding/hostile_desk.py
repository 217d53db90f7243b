"""Programs in the place of a desk's own: what code that has taken over a desk could do.

The text of a submission names the function that its desk runs. A submission that names none is read as usual, so that
a test sees the results of the other students.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import platform
import random
import select
import signal
import time
from typing import TYPE_CHECKING, Any

import msgspec
import re2

from autograder.boxes import desk_program
from autograder.boxes.seccomp_filter import ARCHITECTURES
from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding.submitted_notebook import ReadNotebook, SubmittedCell, Unreadable
from tests.boxes.reach import reached

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

_NAMED = re2.compile(rb"hostile: (\w+) ?(\d*)")
_CALLS = ARCHITECTURES[platform.machine()].calls
_PTRACE, _UNSHARE = _CALLS["ptrace"], _CALLS["unshare"]
RAW = b"raw "
SCRIPT = "<script>fired()</script><img src=x onerror=fired()>"

CRAFTED: tuple[bytes, ...] = (
    *(b"", b"null", b"[]", b"{}", b'{"type": "Other"}', b'{"type": "Unreadable", "reason": ""}', b"\xff"),
    b"[" * 900_000,
    *(b'{"type": "ReadNotebook", "cells": %s, "left_out": 0}' % cells for cells in (
        b"null", b"{}", b"[1]", b"[[]]", b'[{"kind": "shell", "source": ""}]',
        b'[{"kind": "code", "source": "\\ud800"}]',
        b'[{"kind": "code", "source": 1}]', b'[{"kind": "code", "source": "%s"}]' % (b"x" * 100_001),
        b'[{"kind": "code", "source": "", "grade_id": "%s"}]' % (b"x" * 201),
        b'[{"kind": "code", "source": "", "pictures": [["a", "image/svg+xml", "PHN2Zz4="]]}]',
        b'[{"kind": "code", "source": "", "pictures": [["a", "image/png", "<script>"]]}]',
        b"[%s]" % b", ".join([b'{"kind": "code", "source": "%s"}' % (b"x" * 99_000)] * 11),
        b"[%s]" % b", ".join([b'{"kind": "code", "source": ""}'] * 2_001),
    )),
    b'{"type": "ReadNotebook", "cells": [], "left_out": -1}',
    b'{"type": "ReadNotebook", "cells": [], "left_out": 1e999}',
    b'{"type": "Unreadable", "reason": "%s"}' % (b"x" * 301),
)  # fmt: skip
"""Documents that no notebook has."""


def prepare(*readers: str) -> None:
    """Be as ready as a desk."""
    desk_program.prepare(*readers)
    if "ILL" in os.environ:
        desk_program._readers["submission"].rehearse = lambda: crash(-1, 0)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Do what the submission names; what begins with ``raw`` is the answer itself."""
    source, answer = descriptors
    data = os.pread(source, 1_000_000, 0)
    named = _NAMED.search(data)
    if data.startswith(RAW):
        os.write(answer, data.removeprefix(RAW))
    elif named is None:
        desk_program.run(call, descriptors)
    else:
        globals()[named[1].decode()](answer, int(named[2] or 0))


def at_random(answer: int, number: int) -> None:
    os.write(answer, random.Random(number).randbytes(10_000))


def crafted(answer: int, number: int) -> None:
    _write(answer, CRAFTED[number])


def endless(answer: int, number: int) -> None:
    while True:
        pass


def endless_answer(answer: int, number: int) -> None:
    piece = bytes(1 << 20)
    while True:
        with contextlib.suppress(OSError):
            os.write(answer, piece)


def late(answer: int, number: int) -> None:
    """Wait, in any way that there is, and answer then; else say that nothing waits."""
    for wait in (lambda: time.sleep(3600), lambda: select.select([], [], [], 3600), signal.pause):
        with contextlib.suppress(OSError, RuntimeError):
            wait()
    _write(answer, msgspec.json.encode(Unreadable("nothing waits")))


def no_memory(answer: int, number: int) -> None:
    bytearray(10**9)


def crash(answer: int, number: int) -> None:
    ctypes.string_at(0)


def leave(answer: int, number: int) -> None:
    os._exit(7)


def in_ada_s_name(answer: int, number: int) -> None:
    """An answer with all that might be another student's."""
    document = msgspec.to_builtins(ReadNotebook((_cell("def Talker():\n    return 1", "Talker"),), 0))
    of_ada = {"student": "ada", "assignment": "lab_1_2", "notebook": "lab_1_2", "key": "ada", "seed": "0"}
    _write(answer, msgspec.json.encode({**document, **of_ada}))


def script(answer: int, number: int) -> None:
    """Script in each text."""
    cells = (
        _cell(f"#{SCRIPT}\ndef Talker():\n    return 3", "Talker"),
        _cell(SCRIPT, SCRIPT),
        _cell(SCRIPT, kind="markdown"),
    )
    _write(answer, msgspec.json.encode(ReadNotebook(cells, 2_000)))


def script_in_the_reason(answer: int, number: int) -> None:
    _write(answer, msgspec.json.encode(Unreadable(f"{SCRIPT}\n\x1b[2Jrefused: ada\u202e")))


def reach(answer: int, number: int) -> None:
    """Say what a desk can reach."""
    _write(answer, msgspec.json.encode(Unreadable(f"reached: {_reached()}")))


def reach_from_an_archive(answer: int, number: int) -> None:
    """Say it as a desk says of an archive what is in it."""
    found = _reached()
    _write(answer, f'{{"names": ["reached"], "size": {len(found)}}}\n{found}'.encode())


def _reached() -> str:
    libc = ctypes.CDLL(None, use_errno=True)

    def call(*arguments: Any) -> None:
        if libc.syscall(*arguments) < 0:
            raise OSError(ctypes.get_errno(), "")

    further: dict[str, Callable[[], Any]] = {
        "another's memory": lambda: call(_PTRACE, 16, 1, 0, 0),
        "a namespace": lambda: call(_UNSHARE, 0x10000000),
    }
    return reached(further)


def _cell(source: str, name: str = "", kind: str = "code") -> SubmittedCell:
    return SubmittedCell(CellType(kind), source, name, name)


def _write(answer: int, data: bytes) -> None:
    with contextlib.suppress(OSError):
        while data:
            data = data[os.write(answer, data) :]
