"""Exercise 1.1, the package: the launch file of step 2, installed by the package of the programs that it starts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from exercise_1_1 import remap

from autograder.kit import Criterion, Finding, Mistake, mistake, unless
from autograder.kit.mistakes import package_mistakes
from autograder.kit.mistakes.package_mistakes import package_name, package_of
from autograder.kit.output.workspace_reports import report_of
from autograder.kit.runners import LaunchesFromPackage

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit import Evidence

PACKAGE, FILE = "my_robot_pkg", "remap.launch"
FOLDER = f"share/{PACKAGE}/launch"
SHOWN = f"{FILE}.py"
IN_PLACE = f"the build puts {SHOWN} into {FOLDER}"


def not_in_place(evidence: Evidence) -> str:
    """Say what the build has done instead of putting the launch file where launch files belong."""
    report = package_mistakes.build_report(evidence.main)
    if report is None:
        return "no workspace was built"
    if not report.built:
        return package_mistakes.seen_of_build(report)
    files = _launch_files(evidence, "built")
    in_place = any(str(path.parent) == FOLDER for path in _named(files))
    # What a long report has left out is not judged as missing.
    return "" if in_place or not (report.complete or report.missing) else ", ".join(files) or "no launch file"


def launched(evidence: Evidence) -> Finding:
    """The installed launch file does all that the exercise about the launch file alone asks for."""
    return remap.EXERCISE.judge_as_one(evidence, "all that step 2 asks for")


def _launch_files(evidence: Evidence, phase: str) -> Sequence[str]:
    """The launch files in the package's folder (phase ``found``), or those that it has installed (``built``)."""
    own = package_of(report_of(evidence.main, phase), PACKAGE)
    return own.launch_files if own else ()


def _named(files: Sequence[str]) -> list[PurePosixPath]:
    """The files of the name that the task asks for, in whatever language of launch files."""
    return [path for path in map(PurePosixPath, files) if path.stem == FILE]


def _misplaced(evidence: Evidence, phase: str) -> Sequence[str] | None:
    """The launch files of a package that is built and has not installed the right one; None for all others."""
    report = report_of(evidence.main)
    wrong = report is not None and report.built and report.missing != PACKAGE and not_in_place(evidence)
    return _launch_files(evidence, phase) if wrong else None


def other_names(evidence: Evidence) -> str:
    """The names of the package's launch files, if none has the name that the task asks for."""
    files = _misplaced(evidence, "found") or ()
    return "" if _named(files) else ", ".join(files)


def not_installed(evidence: Evidence) -> str:
    """The beginning of a sentence about a build that has not installed the launch file; empty if it has."""
    files = _misplaced(evidence, "found")
    if files is None:
        return ""
    return f"The package has {files[0]}, but the build" if files else "The build"


MISTAKES = (
    Mistake("package_name", lambda evidence: package_name(evidence, PACKAGE), certain=True),
    mistake(
        "launch_elsewhere",
        lambda evidence: _named(_misplaced(evidence, "built") or ()),
        f"The build puts {{0[0].name}} into {{0[0].parent}}, and not into {FOLDER}.",
        f"In data_files of setup.py, the first string of a pair is the folder: write {FOLDER}.",
        certain=True,
    ),
    mistake(
        "launch_file_name",
        other_names,
        f"The package has no file {SHOWN}: its launch file is {{}}.",
        f"Call the file {SHOWN}, in the folder of the package and in setup.py. `ros2 launch` looks for exactly the "
        "name that it is given.",
        certain=True,
    ),
    mistake(
        "launch_not_installed",
        not_installed,
        f"{{}} does not install {SHOWN}: `ros2 launch` finds only what the build has put into share/{PACKAGE}.",
        f"The file belongs in the folder ros2_ws/src/{PACKAGE}/launch. The list data_files in setup.py needs one more "
        f"pair: the folder {FOLDER}, and a list with the path of the file, seen from the folder of the package. A "
        "pattern in glob(...) looks from there, too, and has to begin with launch/ and to match the ending of the "
        "file: another one finds nothing, and the build does not say so.",
        certain=True,
    ),
)

EXERCISE = replace(
    remap.EXERCISE,
    id="exercise_1_1.package",
    title="Exercise 1.1 · The launch file in the package",
    task="A launch file that the package of its programs installs, and that ros2 launch finds there.",
    criteria=(
        Criterion(
            "installed",
            "The build installs the launch file",
            4,
            unless(IN_PLACE, not_in_place, "it is there"),
        ),
        Criterion("launched", "Launched from there, it does all that step 2 asks for", 6, launched),
    ),
    mistakes=(*MISTAKES, *remap.EXERCISE.mistakes),
    runner=LaunchesFromPackage(PACKAGE, FILE),
    wraps_commands=False,
    text={
        "copy your launch file of step 2 into it. The file keeps its name.": "installed",
        "Write the pair that installs your launch file into the folder `share/my_robot_pkg/launch`.": "installed",
        "The file has to do everything that step 2 asks for.": "launched",
    },
    counts={
        "installed": "A file in XML or YAML counts as well. What you write into `setup.py` yourself belongs into the "
        "cell, too: a class is graded by its cells.",
    },
)
