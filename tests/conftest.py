"""What holds for every test, and how ``./course test`` shares the tests out among processes."""

from __future__ import annotations

import functools
import gc
import os
import signal
import sys
from typing import TYPE_CHECKING, Any

import pytest

# Has Python find the labs, whose modules tests import.
import autograder.exercises
from tests import hasty_disk, tiers
from tests.reach.changes import NoCommit, Selection, selection

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator
    from pathlib import Path

# Where a user's Python keeps no bytecode, each of the thousand processes that tests start would compile anew what it
# imports, and each process of tests all tests.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# Started in the background of a shell without job control, a process ignores Ctrl-C, and so does all that it starts
# (POSIX, "Asynchronous Lists"). Tests send SIGINT to what they start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

TOGETHER = ("tests/attacks", "tests/boxes", "tests/execution", "tests/notebook/checking")
"""Folders whose tests share what takes long to make, or mostly wait, so that one process runs them all."""
APART = ("tests/authoring/test_reference_files.py", "tests/authoring/test_new_exercise.py")
"""Files with long tests that share nothing, so that several processes take them."""
LONGEST = (
    "tests/judge/test_bank.py",
    # It waits for four minutes, and needs a processor for half a minute of them.
    "tests/notebook/checking",
    "tests/attacks",
    "tests/authoring/test_notebooks.py",
    "tests/grading/cluster/test_cluster.py",
    "tests/grading/new_classes/test_sample_class.py",
    "tests/authoring/test_reference_files.py",
    "tests/grading/day/test_killed_at_random.py",
    "tests/benchmarks/test_short_run.py",
    "tests/grading/running/test_order_executor.py",
    "tests/browser",
    "tests/boxes",
    "tests/execution",
    "tests/judge/test_misnamed.py",
    "tests/test_handed_out_answers.py",
    "tests/workspaces/test_graded_notebooks.py",
    "tests/environment/ros2_command/test_graph.py",
    "tests/grading/classes/test_class_lock.py",
    "tests/workspaces",
    "tests/authoring",
    "tests/masters/test_run_again.py",
    "tests/masters/test_programs.py",
    "tests/test_second_chapter.py",
    "tests/test_adding_an_exercise.py",
    "tests/test_left_behind.py",
    "tests/test_wheel.py",
    "tests/test_cli.py",
    "tests/mutation",
    "tests/grading",
)
"""Begun first, so that nobody waits for one of them at the end."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Called by pytest-xdist (its documentation, "Identifying workers" and hooks)."""
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        """A process takes a file of tests at a time, the longest first."""

        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.split("::")[0]
            if file in APART:
                return nodeid
            return next((folder for folder in TOGETHER if file.startswith(f"{folder}/")), file)

    config.option.loadscopereorder = False
    return ByFile(config, log)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One process for each core, one that mostly waits for the bank, and one that mostly waits for checks in notebooks.

    On two cores the tests took 518 s with four processes, and 547 s with three by a simulation of their queue.
    """
    from autograder.grading.running.execution_backends import cores

    return cores() + 2


def pytest_addoption(parser: pytest.Parser) -> None:
    """The tiers."""
    parser.addoption("--all", action="store_true", help="also the tests that are left to the nightly run")
    parser.addoption("--smoke", action="store_true", help="only a few tests of each part")
    parser.addoption(
        "--changed",
        nargs="?",
        const="",
        metavar="COMMIT",
        help="only the tests that reach what has changed since a commit, and a few of each part",
    )


def pytest_configure(config: pytest.Config) -> None:
    """A contributor who names tests gets all of them. The processes of pytest-xdist are told what was decided."""
    if hasattr(config, "workerinput"):
        config.option.all = config.workerinput["all"]
        told = config.workerinput["selection"]
        config.stash[_SELECTION] = Selection.from_json(told) if told else None
        if digests := config.workerinput["digests"]:
            from tests.measure import stimulus

            stimulus.KNOWN.update(digests)
        return
    if config.args_source is not pytest.Config.ArgsSource.TESTPATHS and config.option.changed is None:
        config.option.all = True
    try:
        changed = config.option.changed
        config.stash[_SELECTION] = None if changed is None else selection(config.rootpath, changed)
    except NoCommit as error:
        raise pytest.UsageError(str(error)) from None


_SELECTION = pytest.StashKey[Selection | None]()


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Called by pytest-xdist for each of its processes, which reads the command line anew and knows no more than it."""
    node.workerinput["all"] = node.config.option.all
    chosen = node.config.stash[_SELECTION]
    whole = node.config.args_source is pytest.Config.ArgsSource.TESTPATHS
    node.workerinput["selection"] = chosen.as_json() if chosen else ""
    node.workerinput["digests"] = _digests() if whole and chosen is None else {}


def _digests() -> dict[str, str]:
    """What decides on each exercise's evidence, for all processes: making it took each of them four seconds."""
    from tests.measure import stimulus

    return {exercise_id: stimulus.digest(exercise_id) for exercise_id in autograder.exercises.all_ids()}


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Which tier this is, how its draw is repeated, and what is judged itself for want of present evidence."""
    if config.option.all:
        return ["tier: all"]
    drawn = f"as drawn by {tiers.SEED}={tiers.seed()}"
    if config.option.smoke:
        return [f"tier: smoke, {drawn}"]
    if chosen := config.stash[_SELECTION]:
        return [f"tier: changed since {chosen.base}, {drawn}", *chosen.described()]
    from tests.measure import evidence

    lines = [f"tier: short, {drawn}"]
    if changed := evidence.exercises_of_another_bench():
        lines.append(f"judged whole, as the bench or the scenario has changed: {' '.join(changed)}")
        lines.append(f"(shorter again after {evidence.COMMAND})")
    return lines


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Skip the files in which no test can be selected: collecting all of them takes half a minute of a processor."""
    chosen = config.stash[_SELECTION]
    path = collection_path.relative_to(config.rootpath).as_posix()
    ours = collection_path.suffix == ".py" and path.startswith("tests/")
    return True if ours and chosen and not chosen.may_be_in(path) and not tiers.is_smoke(path) else None


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """A third of the time of collecting thousands of tests went into looking for garbage among them, which stay."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Those of this tier, the longest first."""
    if not config.option.all:
        left = _left_out(config, items)
        config.hook.pytest_deselected(items=[item for item in items if item.nodeid in left])
        items[:] = [item for item in items if item.nodeid not in left]
    items.sort(key=_rank)


def _left_out(config: pytest.Config, items: list[pytest.Item]) -> set[str]:
    """Return the ids of the tests that are not of this tier."""
    ids = [item.nodeid for item in items]
    due = [item.nodeid for item in items if item.get_closest_marker("due")]
    chosen = config.stash[_SELECTION]
    if config.option.smoke:
        return set(ids) - tiers.smoke(ids)
    if chosen is None or chosen.because:
        return tiers.left_to_all(ids, due)
    left = tiers.never_drawn(ids)
    reaching = [one for one in ids if one not in left and chosen.includes(one)]
    return set(ids) - (set(reaching) - tiers.too_many(reaching)) - tiers.smoke(ids)


def _rank(item: pytest.Item) -> int:
    return next((rank for rank, name in enumerate(LONGEST) if item.nodeid.startswith(name)), len(LONGEST))


@pytest.fixture(scope="session", autouse=True)
def _no_waiting_for_the_disk() -> Iterator[None]:
    with hasty_disk.no_waiting():
        yield


@pytest.fixture(scope="session", autouse=True)
def _nothing_remembered(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Checks that tests make are nobody's progress, and their classes are not the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AUTOGRADER_JOURNAL", "")
        patch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.fixture(scope="session", autouse=True)
def _gradebook_version() -> Iterator[None]:
    """For each new gradebook nbgrader starts a program that says the same as the last time, in two or three seconds."""
    # Where no test has imported nbgrader, none makes a gradebook in this process.
    api = sys.modules.get("nbgrader.api")
    if api is None:
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(api, "get_alembic_version", functools.cache(api.get_alembic_version))
        yield
