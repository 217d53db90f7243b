"""Exercise 1.1, the package: the launch file of step 2, installed by the package of the programs that it starts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from exercise_1_1 import remap

from autograder.kit.mistakes import package_mistakes
from autograder.kit.mistakes.package_mistakes import package_name, package_of
from autograder.kit.model import Advice, Criterion, Finding, Mistake
from autograder.kit.runners import LaunchesFromPackage, report_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.evidence import Evidence

PACKAGE, FILE = "my_robot_pkg", "remap.launch"
FOLDER = f"share/{PACKAGE}/launch"
SHOWN = f"{FILE}.py"


def installed(evidence: Evidence) -> Finding:
    """The build has put the launch file into the folder of the package where launch files belong."""
    expected = f"the build puts {SHOWN} into {FOLDER}"
    report = package_mistakes.build_report(evidence.main)
    if report is None:
        return Finding(False, expected, "no workspace was built")
    if not report.built:
        return Finding(False, expected, package_mistakes.seen_of_build(report))
    found = _launch_files(evidence, "built")
    # What a long report has left out is not judged as missing.
    in_place = any(str(path.parent) == FOLDER for path in _named(found))
    there = in_place or not (report.complete or report.missing)
    return Finding(
        there, expected, "it is there" if there else ", ".join(found) or "no launch file is installed"
    )


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


def _about_the_file(recognize: Callable[[Sequence[str], Sequence[str]], Advice | None]) -> Mistake:
    """A mistake that shows in a package's launch files and the installed ones, once the package is built."""

    def advice(evidence: Evidence) -> Advice | None:
        report = report_of(evidence.main)
        if report is None or not report.built or report.missing == PACKAGE or installed(evidence).passed:
            return None
        return recognize(_launch_files(evidence, "found"), _launch_files(evidence, "built"))

    return Mistake(recognize.__name__, advice, certain=True)


def launch_elsewhere(_: Sequence[str], built: Sequence[str]) -> Advice | None:
    """The launch file is installed, and in another folder."""
    if not (files := _named(built)):
        return None
    return Advice(
        f"The build puts {files[0].name} into {files[0].parent}, and not into {FOLDER}.",
        f"In data_files of setup.py, the first string of a pair is the folder: write {FOLDER}.",
    )


def launch_file_name(found: Sequence[str], _: Sequence[str]) -> Advice | None:
    """The package has launch files, all of other names."""
    if not found or _named(found):
        return None
    return Advice(
        f"The package has no file {SHOWN}: its launch file is {', '.join(found)}.",
        f"Call the file {SHOWN}, in the folder of the package and in setup.py. `ros2 launch` looks for exactly the "
        "name that it is given.",
    )


def launch_not_installed(found: Sequence[str], _: Sequence[str]) -> Advice:
    """The build has not installed the launch file, or there is none in the package."""
    there = f"The package has {found[0]}, but the build" if found else "The build"
    return Advice(
        f"{there} does not install {SHOWN}: `ros2 launch` finds only what the build has put into share/{PACKAGE}.",
        f"The file belongs in the folder ros2_ws/src/{PACKAGE}/launch. The list data_files in setup.py needs one more "
        f"pair: the folder {FOLDER}, and a list with the path of the file, seen from the folder of the package. A "
        "pattern in glob(...) looks from there, too, and has to begin with launch/ and to match the ending of the "
        "file: another one finds nothing, and the build does not say so.",
    )


EXERCISE = replace(
    remap.EXERCISE,
    id="exercise_1_1.package",
    title="Exercise 1.1 · The launch file in the package",
    task="A launch file that the package of its programs installs, and that ros2 launch finds there.",
    criteria=(
        Criterion("installed", "The build installs the launch file", 4, installed),
        Criterion("launched", "Launched from there, it does all that step 2 asks for", 6, launched),
    ),
    mistakes=(
        Mistake("package_name", lambda evidence: package_name(evidence, PACKAGE), certain=True),
        *map(_about_the_file, (launch_elsewhere, launch_file_name, launch_not_installed)),
        *remap.EXERCISE.mistakes,
    ),
    runner=LaunchesFromPackage(PACKAGE, FILE),
    wraps_commands=False,
    text={
        "copy your launch file of step 2 into it. The file keeps its name.": "installed",
        "Write the pair that installs your launch file into the folder `share/my_robot_pkg/launch`.": "installed",
        "The file has to do everything that step 2 asks for.": "launched",
    },
)
