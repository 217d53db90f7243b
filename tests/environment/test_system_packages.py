"""The words and the installation for a missing system package."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_runtime import system_packages
from course_runtime.system_packages import (
    TABLE,
    Apt,
    MissingPackagesError,
    SystemPackage,
    get_with,
    missing,
    provide,
    require,
)

if TYPE_CHECKING:
    from pathlib import Path


class Machine:
    """A machine with an apt-get that writes down its arguments and brings a package, or does not."""

    def __init__(self, folder: Path, brings: bool = True):
        self.folder = folder
        self.log = folder / "apt.txt"
        self.thing = folder / "thing"
        bring = f"touch '{self.thing}'" if brings else "exit 100"
        program = folder / "apt-get"
        program.write_text(
            f'#!/bin/sh\necho "$DEBIAN_FRONTEND $*" >> \'{self.log}\'\n[ "$1" = update ] || {bring}\n'
        )
        program.chmod(0o755)
        self.root = Apt(str(program), as_root=True)
        self.user = Apt(str(program), as_root=False)
        row = SystemPackage("a thing", "to do it", "setup", ("thing", "thing-dev"), self.thing.exists)
        self.table = (row,)

    def provide(self, apt: Apt) -> tuple[list[SystemPackage], list[str]]:
        """Return the rows that are still missing, and what the user was told."""
        said: list[str] = []
        with (self.folder / "log.txt").open("w") as log:
            return provide("setup", log, said.append, apt, self.table), said


def test_root_on_debian_gets_it_installed(tmp_path: Path) -> None:
    machine = Machine(tmp_path)
    assert machine.provide(machine.root) == ([], ["installing a thing with apt-get"])
    assert machine.log.read_text().splitlines() == [
        "noninteractive update",
        "noninteractive install -y --no-install-recommends thing thing-dev",
    ]


def test_what_is_there_is_not_installed(tmp_path: Path) -> None:
    machine = Machine(tmp_path)
    machine.thing.touch()
    assert machine.provide(machine.root) == ([], [])
    assert not machine.log.exists()


def test_an_ordinary_user_gets_nothing_installed(tmp_path: Path) -> None:
    machine = Machine(tmp_path)
    assert machine.provide(machine.user) == (list(machine.table), [])
    assert not machine.log.exists()


def test_an_installation_that_fails_leaves_it_missing(tmp_path: Path) -> None:
    machine = Machine(tmp_path, brings=False)
    assert machine.provide(machine.root)[0] == list(machine.table)


def test_what_the_set_up_needs_is_an_error_with_the_command_to_type(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine = Machine(tmp_path)
    monkeypatch.setattr(system_packages, "missing", lambda need, table=(): list(machine.table))
    with (tmp_path / "log.txt").open("w") as log, pytest.raises(MissingPackagesError) as caught:
        require("setup", log, lambda line: None, machine.user)
    assert str(caught.value) == (
        "a thing (to do it) is missing. Get it with: sudo apt-get install -y thing thing-dev"
    )


def test_without_apt_get_the_things_are_named(tmp_path: Path) -> None:
    assert get_with(Machine(tmp_path).table, Apt(None, as_root=True)) == (
        "Get a thing with the package manager of your system."
    )


def test_compilers_are_taken_from_the_variables_that_cmake_reads(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    for name in ("CC", "CXX"):
        monkeypatch.delenv(name, raising=False)
    assert system_packages.find_compilers() is None
    for name in ("my-cc", "my-c++"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("CC", "my-cc -m64")
    assert system_packages.find_compilers() is None
    monkeypatch.setenv("CXX", "my-c++")
    assert system_packages.find_compilers() == (str(tmp_path / "my-cc"), str(tmp_path / "my-c++"))


def test_the_table_is_complete() -> None:
    assert {row.need for row in TABLE} == {"setup", "tests", "sandbox"}
    assert all(row.title and row.reason.startswith(("to ", "for ")) and row.debian for row in TABLE)


def test_this_machine_has_what_the_set_up_needs() -> None:
    assert missing("setup") == []
