"""In the process that speaks with a cluster, no pickle runs anything."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from autograder.grading.cluster.inert_pickle import Inert, loads
from tests.cases import cases


class Calls:
    """Its pickle calls a function."""

    def __init__(self, function: Any, *arguments: Any) -> None:
        self._call = function, arguments

    def __reduce__(self) -> Any:
        return self._call


@pytest.mark.parametrize(
    "value", [None, 1, 1.5, "text", b"bytes", [1, "2"], {"a": (1, 2)}, {3}, frozenset({4}), bytearray(b"5")]
)
def test_plain_values_come_through(value: object) -> None:
    assert loads(pickle.dumps(value)) == value


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_a_call_is_not_made(tmp_path: Path, protocol: int) -> None:
    there = tmp_path / "there"
    for call in (
        Calls(os.system, f"touch {there}"),
        Calls(exec, f"open({str(there)!r}, 'w')"),
        Calls(Path.touch, there),
    ):
        loads(pickle.dumps(call, protocol))
        assert not there.exists()
        pickle.loads(pickle.dumps(call, protocol))  # the same pickle would have
        assert there.exists()
        there.unlink()


def test_an_error_keeps_its_name_and_words() -> None:
    error = loads(pickle.dumps(ModuleNotFoundError("No module named 'autograder'")))
    assert isinstance(error, Inert)
    assert repr(error) == "ModuleNotFoundError(\"No module named 'autograder'\")"


def test_an_error_keeps_its_words_as_tblib_writes_it() -> None:
    tblib = pytest.importorskip("tblib.pickling_support", reason="./course setup --with cluster installs it")
    try:
        raise tblib.install() or RuntimeError("own words")
    except RuntimeError as raised:
        tblib.install(raised)
        error = loads(pickle.dumps(raised))
    assert isinstance(error, Inert)
    assert "own words" in str(error)


CLIENT = cases(__file__, "CLIENT")


def test_nothing_in_the_client_process_has_kept_the_real_one() -> None:
    pytest.importorskip("distributed", reason="./course setup --with cluster installs it")
    done = subprocess.run([sys.executable, "-c", CLIENT], capture_output=True, text=True, check=True)
    assert done.stdout == ""


INSTALLED = cases(__file__, "INSTALLED")


def test_installing_replaces_every_way_to_read_a_pickle() -> None:
    done = subprocess.run([sys.executable, "-c", INSTALLED], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["Inert"] * 3
