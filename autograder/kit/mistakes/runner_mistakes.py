"""The mistakes that a runner brings, whatever the recipe: of a build, and of a launch file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import re2

from autograder import known_errors
from autograder.kit.mistakes.crashes import OTHER_CRASHES
from autograder.kit.mistakes.package_mistakes import BUILD, EntryPoint, in_package
from autograder.kit.model import Advice, Mistake, card_words, filled_in, mistake
from autograder.kit.output.launched_processes import processes
from autograder.kit.runners import Launches, LaunchesFromPackage, RunsProgram, RunsPrograms, ServesInterface

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.runners import Runner

_WORDS = card_words(__file__)

OF_THE_WORKSPACE: Mapping[type[Runner], Callable[[Any], Sequence[Mistake]]] = {
    RunsProgram: lambda runs: in_package(runs.package, EntryPoint(runs.package, runs.program)),
    RunsPrograms: lambda runs: in_package(
        runs.package, *(EntryPoint(runs.package, p) for p in runs.programs)
    ),
    ServesInterface: lambda _: BUILD,
    Launches: lambda _: BUILD,
    LaunchesFromPackage: lambda runs: in_package(runs.package),
}
"""For each kind of runner, the mistakes that keep the workspace from being built or its program from being found."""
OF_A_LAUNCH = (Launches, LaunchesFromPackage)
"""The kinds of runners whose subject is a launch file."""


def with_those_of(runner: Runner | None, ladder: Sequence[Mistake]) -> Sequence[Mistake]:
    """Return a recipe's mistakes with those that the runner brings, unless the recipe already has these."""
    keys = {known.key for known in ladder}
    if runner is not None and "build_failed" not in keys:
        ladder = (*OF_THE_WORKSPACE[type(runner)](runner), *ladder)
    if not isinstance(runner, OF_A_LAUNCH) or "launch_error" in keys:
        return ladder
    kept = [known for known in ladder if known.key not in _OF_A_PROGRAM]
    at = kept.index(OTHER_CRASHES[0]) if OTHER_CRASHES[0] in kept else len(kept)
    return (*kept[:at], *LAUNCH, *kept[at:], *NOTHING_LAUNCHED)


_OF_A_PROGRAM = ("main_guard", "nothing_on_the_graph", "ended_too_early")
"""The keys of mistakes whose advice is about main(), which a launch file does not have."""


_COMPARE = "Compare the file with the example. Begin with the line that the message names."


def _launch_error(evidence: Evidence) -> Advice | None:
    """Return advice if the launch failed and reported the reason."""
    what = complaint(evidence.main)
    known = known_errors.recognized(what, "launch")
    return Advice(f"The launch failed: {what}", known.do if known else _COMPARE) if what else None


def complaint(part: Part) -> str:
    """Return the launch's error message without the text around it; empty if there is none."""
    lines = [str(event.data["text"]) for event in part.of("output")]
    for number, line in enumerate(lines):
        if "[ERROR] [launch]:" not in line and not line.startswith("ros2: "):
            continue
        causes = [later.removeprefix(" - ") for later in lines[number + 1 :] if later.startswith(" - ")]
        what = (causes or [line.partition("[launch]:")[2].strip() or line])[-1]
        what = what.removeprefix("Caught exception in launch (see debug for traceback):").strip()
        return re2.sub(r" on the libexec directory '[^']*'|, searching: \[.*| in '/[^']*'", "", what)
    return ""


def _syntax_error(evidence: Evidence) -> Advice | None:
    """Return advice if Python cannot parse the launch file."""
    what = complaint(evidence.main)
    if not re2.match(r"(?:Syntax|Indentation|Tab)Error", what):
        return None
    return filled_in(_WORDS["syntax_error"], what=what)


LAUNCH = (
    Mistake("syntax_error", _syntax_error, certain=True),
    Mistake("launch_error", _launch_error, certain=True),
)
"""The mistakes in a launch file that the launch reports."""


def _nodeless(evidence: Evidence, *, started: bool) -> bool:
    return not evidence.main.had_node and bool(processes(evidence.main)) is started


NOTHING_LAUNCHED = (
    mistake(
        "nothing_on_the_graph",
        lambda evidence: _nodeless(evidence, started=False),
        *_WORDS["nothing_started"],
    ),
    mistake("nothing_on_the_graph", lambda evidence: _nodeless(evidence, started=True), *_WORDS["no_node"]),
    mistake("ended_too_early", lambda evidence: evidence.main.ending is not None, *_WORDS["ended_too_early"]),
)
"""The mistakes that are checked last under a launch."""
