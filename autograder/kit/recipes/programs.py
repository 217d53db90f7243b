"""The programs of a package: each is run as in a terminal of its own, judged as its node is, and ended with Ctrl-C."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, cast

from autograder.kit import common_mistakes as common
from autograder.kit import package_programs as package
from autograder.kit import workspace_mistakes as workspace
from autograder.kit.evidence import INTERRUPTED, Evidence, Part
from autograder.kit.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake
from autograder.kit.runners import RunsPrograms
from autograder.kit.workspace_report import report_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

ENDING = {Look.FAST: 3.0, Look.REAL_TIME: 10.0}
"""Seconds of wall time in which a program must have ended after Ctrl-C; it takes a tenth of one."""

_ROLES = ("publisher", "subscription", "client", "service", "action_client", "action_server")


@dataclass(frozen=True)
class Program:
    """A program of the package.

    Attributes:
        name: As ``ros2 run`` knows it; its file is called so, too.
        node: The exercise about its node alone. The program has to do all that is asked for there.
        title: Of its criterion, one line for a person.
        points: Of its criterion.
    """

    name: str
    node: Exercise
    title: str
    points: float

    @property
    def prefix(self) -> str:
        """How the names of its parts begin."""
        return f"{self.name}: "

    def parts(self, every: Iterable[Part]) -> list[Part]:
        """Its runs, under the names that the exercise of its node knows, from their start to their very end."""
        own = [part for part in every if part.name.startswith(self.prefix)]
        return [replace(part, name=part.name.removeprefix(self.prefix)) for part in own]

    def view(self, evidence: Evidence) -> Evidence:
        """What the exercise of its node is to look at: its own runs, up to Ctrl-C."""
        return Evidence(
            [_before_ctrl_c(part) for part in self.parts(evidence)],
            replace(evidence.reference, parts=self.parts(evidence.reference.parts)),
            evidence.real_time,
            self.view(evidence.before) if evidence.before else None,
        )

    def judge(self, evidence: Evidence) -> Finding:
        """The first criterion of its node that does not hold; where all do, that."""
        findings = [criterion.judge(self.view(evidence)) for criterion in self.node.criteria]
        wrong = [finding for finding in findings if not finding.passed]
        return wrong[0] if wrong else Finding(True, findings[0].expected, "all that is asked of its node")

    def ending(self, evidence: Evidence) -> str:
        """What became of it at Ctrl-C, in a few words; empty where it ended by that."""
        for part in self.parts(evidence):
            pressed = part.first("subject", INTERRUPTED)
            if pressed is None:
                return "ended by itself" if part.ending else "did not get so far"
            if part.ending is None:
                return "went on"
        return "" if self.parts(evidence) else "did not run"


class _OneProgram:
    """A bench for the scenario of one program's node: all words are the bench's, but for these."""

    def __init__(self, bench: Bench, program: Program) -> None:
        self._bench, self._program = bench, program
        self.built = False
        self.before = program.view(bench.before) if bench.before else None
        parts = program.parts(bench.reference.parts)
        self.reference = replace(bench.reference, parts=parts)

    def __getattr__(self, word: str) -> Any:
        return getattr(self._bench, word)

    def part(self, name: str, **inputs: Any) -> None:
        self._bench.part(f"{self._program.prefix}{name}", **inputs)

    def keep(self, name: str) -> bool:
        return self._bench.keep(f"{self._program.prefix}{name}")

    def wait_until(
        self, condition: Callable[[Evidence], bool], within: float, *, quiet: float | None = None
    ) -> bool:
        return self._bench.wait_until(lambda e: condition(self._program.view(e)), within, quiet=quiet)

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        return self._bench.watch_graph(lambda e: condition(self._program.view(e)), within)

    def start(self, *arguments: Any, **options: Any) -> None:
        self._bench.start(self._program.name, *arguments, **options)
        package.await_build(self._bench)
        report = workspace.build_report(self._bench.seen())
        self.built = report is None or report.built

    def stop(self) -> None:
        self._bench.press_ctrl_c(ENDING[self._bench.look])
        self._bench.stop()


def _before_ctrl_c(part: Part) -> Part:
    pressed = part.first("subject", INTERRUPTED)
    return part if pressed is None else replace(part, events=part.events[: part.events.index(pressed)])


def _after_ctrl_c(part: Part) -> Part:
    return replace(part, events=part.events[len(_before_ctrl_c(part).events) :])


class Programs:
    """An exercise about the programs of a package, which the judge builds and runs one after the other.

    Args:
        name: The package.
        programs: Its programs, in the order of the task.
        keeps: Programs of an earlier lab, whose entry points must not be lost where their modules are there.
    """

    def __init__(self, name: str, *programs: Program, keeps: Sequence[str] = ()) -> None:
        self._name, self._programs, self._keeps = name, programs, keeps

    def exercise(self, exercise_id: str, title: str, task: str, **more: Any) -> Exercise:
        """The exercise: entry points and Ctrl-C for two points each, and the criteria of the programs.

        Args:
            exercise_id: Such as ``"lab_1_2.programs"``.
            title: For the card.
            task: One sentence: what is asked for.
            more: Further attributes of :class:`autograder.kit.model.Exercise`.
        """
        names = tuple(program.name for program in self._programs)
        return Exercise(
            id=exercise_id,
            title=title,
            task=task,
            scenario=self._scenario,
            criteria=(
                Criterion("entry_points", "Builds, and has its entry points", 2, self._has_entry_points),
                *(
                    Criterion(program.name, program.title, program.points, program.judge)
                    for program in self._programs
                ),
                Criterion("ctrl_c", "Each program ends on Ctrl-C", 2, self._all_end),
            ),
            mistakes=(*self._of_the_package(), *self._of_the_programs()),
            roles=tuple(dict.fromkeys(role for program in self._programs for role in program.node.roles)),
            limit=500.0,
            runner=RunsPrograms(self._name, names),
            remarks=(self._traceback_at_the_end,),
            **more,
        )

    def _scenario(self, bench: Bench) -> None:
        for program in self._programs:
            one = _OneProgram(bench, program)
            program.node.scenario(cast("Bench", one))
            if not one.built:
                return

    # --- criteria ------------------------------------------------------------------------------------------------

    def _has_entry_points(self, evidence: Evidence) -> Finding:
        expected = f"ros2 run starts {_and([p.name for p in self._programs])}"
        report = workspace.build_report(evidence.main)
        if report is not None and not report.built:
            return Finding(False, expected, workspace.seen_of_build(report))
        absent = [program.name for program in self._programs if not self._is_there(program, evidence)]
        if absent:
            return Finding(False, expected, f"it does not start {_and(absent)}")
        lost = self._lost(evidence)
        return Finding(not lost, expected, f"setup.py has lost {_and(lost)}" if lost else "started")

    def _is_there(self, program: Program, evidence: Evidence) -> bool:
        view = program.view(evidence)
        report = report_of(view.main)
        if package.entry_point(view, self._name, program.name):
            return False
        if report is not None:
            return report.built and not report.missing
        return any(part.endpoints(role) for part in view for role in program.node.roles)

    def _lost(self, evidence: Evidence) -> list[str]:
        report = report_of(evidence.main)
        return [name for name in self._keeps if package.lost_entry_point(report, self._name, name)]

    def _all_end(self, evidence: Evidence) -> Finding:
        seen = {program.name: program.ending(evidence) for program in self._programs}
        wrong = "; ".join(f"{name} {what}" for name, what in seen.items() if what)
        return Finding(not wrong, f"{_and(list(seen))} end on Ctrl-C", wrong or "ended")

    # --- mistakes ------------------------------------------------------------------------------------------------

    def _of_the_package(self) -> Iterable[Mistake]:
        yield from workspace.BUILD
        yield Mistake("package_name", lambda e: package.package_name(e, self._name), certain=True)
        for key, recognise in (
            ("wrong_folder", package.wrong_folder),
            ("entry_point", package.entry_point),
            ("entry_point", package.no_executable),
        ):
            for program in self._programs:
                yield Mistake(key, partial(self._about_package, recognise, program), certain=True)
        yield workspace.NOT_SOURCED

    def _about_package(
        self, recognise: Callable[[Evidence, str, str], Advice | None], program: Program, evidence: Evidence
    ) -> Advice | None:
        return recognise(program.view(evidence), self._name, program.name)

    def _of_the_programs(self) -> Iterable[Mistake]:
        yield Mistake("entry_point", self._another_program)
        for program in self._programs:
            late = Mistake("ended_too_early", common.ended_too_early)
            for mistake in (*program.node.mistakes, late):
                yield replace(mistake, recognise=partial(_in_one_program, program, mistake))
        for program in self._programs:
            yield Mistake("ignores_ctrl_c", partial(_ignores_ctrl_c, program))
        yield Mistake("entry_point_lost", self._entry_point_lost, certain=True)

    def _another_program(self, evidence: Evidence) -> Advice | None:
        """A program shows nothing of its own node, and all that another one of them should."""
        for program in self._programs:
            shown = {role for part in program.view(evidence) for role in _ROLES if part.endpoints(role)}
            for other in self._programs:
                if shown and not shown & set(program.node.roles) and shown >= set(other.node.roles):
                    return Advice(
                        f"`ros2 run {self._name} {program.name}` starts a node that does what {other.name} should do.",
                        f"In setup.py, '{program.name} = {self._name}.{program.name}:main' leads to the file "
                        f"{program.name}.py. Is that so, and is the right class in that file?",
                    )
        return None

    def _entry_point_lost(self, evidence: Evidence) -> Advice | None:
        lost = self._lost(evidence)
        if not lost:
            return None
        return Advice(
            f"{lost[0]}.py is still in the package, but setup.py has no entry point for it any more: "
            f"`ros2 run {self._name} {lost[0]}` does not work.",
            f"Put '{lost[0]} = {self._name}.{lost[0]}:main' back into the list console_scripts, beside the new ones. "
            "All programs of a package stand in one list.",
        )

    def _traceback_at_the_end(self, evidence: Evidence) -> str:
        for program in self._programs:
            if any(_after_ctrl_c(part).traceback for part in program.parts(evidence)):
                return (
                    f"{program.name} ends on Ctrl-C with a traceback. Catch KeyboardInterrupt and "
                    "ExternalShutdownException around rclpy.spin, and end with rclpy.try_shutdown()."
                )
        return ""


def _in_one_program(program: Program, mistake: Mistake, evidence: Evidence) -> Advice | None:
    """A common mistake, where this program is not right."""
    if program.judge(evidence).passed and not program.ending(evidence):
        return None
    advice = mistake.recognise(program.view(evidence))
    return Advice(f"{program.name}: {advice.text}", advice.next_step) if advice else None


def _ignores_ctrl_c(program: Program, evidence: Evidence) -> Advice | None:
    if program.ending(evidence) != "went on":
        return None
    return Advice(
        f"After Ctrl-C {program.name} went on running.",
        "Ctrl-C raises KeyboardInterrupt where the program is: catch it outside of the loop or of rclpy.spin, so that "
        "main comes to its end.",
    )


def _and(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
