"""A plain Python package is built once for all texts of its modules, with the files that colcon makes of each."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.authoring.answer_bank import answers
from autograder.workspaces.builds import cached_builds
from autograder.workspaces.builds.colcon_build import describe_workspace, moved_packages
from autograder.workspaces.builds.plain_packages import split
from autograder.workspaces.builds.students_builds import StudentsBuilds
from autograder.workspaces.jobs import BuildJob, PlainJobs
from autograder.workspaces.packages import WORKSPACE, sources_of
from tests.tiers import BUILT, drawn

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import python_package

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.packages import Package


FEW, FEWER = 4, 1
"""Packages of an exercise that are built twice, and in the short tier: other ones in another commit."""


def job_of(workspace: Path, packages: Sequence[Package] = ()) -> BuildJob:
    """The build of all packages of a workspace, or of some."""
    chosen, src = packages or describe_workspace(workspace).packages, workspace / "src"
    tree, moved = sources_of(src, chosen), moved_packages(chosen, src, Path("src"))
    return BuildJob(WORKSPACE, workspace, tree, moved, lambda: False)


def built(workspace: Path) -> Build:
    made = StudentsBuilds().build(describe_workspace(workspace), None)
    assert made.ok, made.log
    return made


def files_in(install: Path | None) -> dict[str, tuple[int, bytes]]:
    """The mode and the content of each file, without compiled ones: no two builds give the same bytes of those."""
    assert install is not None
    every = (path for path in install.rglob("*") if path.is_file() and path.suffix not in (".pyc", ".so"))
    return {str(path.relative_to(install)): (path.stat().st_mode, path.read_bytes()) for path in every}


def different(some: dict[str, tuple[int, bytes]], others: dict[str, tuple[int, bytes]]) -> list[str]:
    """The names of the files that only one install folder has, or that differ."""
    return sorted(name for name in some.keys() | others.keys() if some.get(name) != others.get(name))


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The packages of each run of colcon."""
    seen: list[list[str]] = []
    build = PlainJobs.build

    def counted(self: PlainJobs, job: BuildJob, *rest: object) -> object:
        seen.append([package.name for package in job.packages])
        return build(self, job, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(PlainJobs, "build", counted)
    return seen


def test_another_text_of_a_module_needs_no_run_of_colcon(workspace: Path, runs: list[list[str]]) -> None:
    built(workspace)
    module = workspace / "src" / "tiny_pkg" / "tiny_pkg" / "hello.py"
    module.write_text("text = 'good evening'\n")
    assert b"good evening" in b"".join(data for _, data in files_in(built(workspace).install).values())
    assert runs == [["tiny_pkg"]]
    module.with_name("other.py").touch()
    built(workspace)
    assert len(runs) == 2  # it is in a list of files that setuptools installs


@pytest.mark.slow
@pytest.mark.parametrize("exercise", BUILT)
def test_the_files_of_each_package_of_the_bank_are_those_of_colcon(
    exercise: str,
    tmp_path: Path,
    empty_cache: Path,
    monkeypatch: pytest.MonkeyPatch,
    pytestconfig: pytest.Config,
) -> None:
    few = FEW if pytestconfig.option.all else FEWER
    workspaces: dict[str, Path] = {}
    for number, answer in enumerate(answers([exercise])):
        folder = tmp_path / str(number)
        folder.mkdir()
        answer.unpack(folder)
        found = describe_workspace(folder / WORKSPACE)
        python = [package for package in found.packages if package.build_type == "ament_python"]
        if python and (parts := split(job := job_of(found.workspace, python))) != [job]:
            workspaces.setdefault(parts[-1].tree.digest, found.workspace)
    assert workspaces
    for workspace in (workspaces[digest] for digest in drawn(workspaces, few)):
        for package in describe_workspace(workspace).packages:
            if package.build_type != "ament_python":
                shutil.rmtree(package.folder)
        made = StudentsBuilds().build(describe_workspace(workspace), None)
        ours = files_in(made.install) if made.ok else {}
        shutil.rmtree(empty_cache)
        with monkeypatch.context() as patch:
            patch.setattr(cached_builds, "split", lambda job: [job])
            whole = StudentsBuilds().build(describe_workspace(workspace), None)
        assert (made.ok, made.trouble, made.line) == (whole.ok, whole.trouble, whole.line)
        assert not different(ours, files_in(whole.install) if whole.ok else {})
        shutil.rmtree(empty_cache)


def test_beside_another_package_the_files_are_those_of_colcon_too(
    workspace: Path, empty_cache: Path, runs: list[list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    other = python_package(workspace / "src", "other_pkg")
    setup = (other / "setup.py").read_text()
    (other / "setup.py").write_text(setup.replace("version='0.0.0'", "version='0.0.%d' % 0"))
    manifest = workspace / "src" / "tiny_pkg" / "package.xml"
    depends = "<depend>other_pkg</depend>\n  <license>"
    manifest.write_text(manifest.read_text().replace("<license>", depends))
    ours = files_in(built(workspace).install)
    assert runs == [["other_pkg"], ["tiny_pkg"]]
    shutil.rmtree(empty_cache)
    monkeypatch.setattr(cached_builds, "split", lambda job: [job])
    assert not different(ours, files_in(built(workspace).install))


@pytest.mark.parametrize(
    ("old", "new"), cases(__file__, "a_setup_that_might_do_something_else_is_built_in_full")
)
def test_a_setup_that_might_do_something_else_is_built_in_full(workspace: Path, old: str, new: str) -> None:
    file = workspace / "src" / "tiny_pkg" / "setup.py"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    job = job_of(workspace)
    assert (split(job) == [job]) == (old != new)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("setup.cfg", "[metadata]\nversion = attr: tiny_pkg.VERSION\n"),
        ("setup.cfg", "[metadata\n"),
        ("pyproject.toml", ""),
        ("helper.py", ""),
        ("setuptools/__init__.py", ""),
        ("glob/__init__.py", ""),
        ("setup.py", "#" * 20_000),
    ],
)
def test_files_that_might_let_a_setup_read_modules_are_built_in_full(
    workspace: Path, name: str, text: str
) -> None:
    file = workspace / "src" / "tiny_pkg" / name
    file.parent.mkdir(exist_ok=True)
    with file.open("a", encoding="utf-8") as opened:
        opened.write(text)
    job = job_of(workspace)
    assert split(job) == [job]


def test_packages_beside_a_plain_one_keep_their_texts(workspace: Path) -> None:
    other = python_package(workspace / "src", "other_pkg")
    (other / "setup.py").write_text("print('building')\n" + (other / "setup.py").read_text())
    rest, plain = split(job_of(workspace))
    assert [package.name for package in rest.packages] == ["other_pkg"]
    assert [package.name for package in plain.packages] == ["tiny_pkg"]
    assert "from the workspace" in repr(rest.tree)
    assert "from the workspace" not in repr(plain.tree)
    assert split(plain) == [plain]
