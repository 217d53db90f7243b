"""A recipe for an exercise about several programs of a package.

The judge runs each program as in a terminal, judges it like the node in that node's exercise, and ends it with Ctrl-C.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, cast

from autograder.kit.bench import Bench, Pace
from autograder.kit.evidence import INTERRUPTED, Evidence, Part
from autograder.kit.mistakes import package_mistakes, unfinished
from autograder.kit.model import Advice, Criterion, Exercise, Finding, Mistake
from autograder.kit.output.workspace_reports import report_of
from autograder.kit.runners import RunsPrograms

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

ENDING = {Pace.FAST: 3.0, Pace.REAL_TIME: 10.0}
"""Time limit in seconds of wall time for a program to end after Ctrl-C. A tenth of a second is usual."""

_ROLES = ("publisher", "subscription", "client", "service", "action_client", "action_server")


@dataclass(frozen=True)
class LabProgram:
    """A program of the package.

    Attributes:
        name: The name of the program for ``ros2 run``.
        node: The exercise about the program's node. The program must meet all criteria of that exercise.
        title: The title of the criterion about this program, as the card shows it.
        points: The points that this criterion is worth.
        file: The name of the program's file without ``.py``; empty if the file has the program's name.
        ends_by_itself: True if the program should end by itself, as a client does after its answer. If False, the judge
            presses Ctrl-C.
    """

    name: str
    node: Exercise
    title: str
    points: float
    file: str = ""
    ends_by_itself: bool = False

    @property
    def prefix(self) -> str:
        """The prefix of the names of this program's parts."""
        return f"{self.name}: "

    def parts(self, every: Iterable[Part]) -> list[Part]:
        """Return this program's runs. Each is named like the same run in the exercise that checks only the node."""
        own = [part for part in every if part.name.startswith(self.prefix)]
        return [replace(part, name=part.name.removeprefix(self.prefix)) for part in own]

    def view(self, evidence: Evidence) -> Evidence:
        """Return the evidence for the exercise about the program's node: this program's runs until Ctrl-C."""
        expected = evidence.reference
        ends = {role: expected.interface.get(role, {}) for role in self.node.roles}
        return Evidence(
            [_before_ctrl_c(part) for part in self.parts(evidence)],
            replace(expected, parts=self.parts(expected.parts), interface=ends),
            evidence.real_time,
            self.view(evidence.before) if evidence.before else None,
        )

    def judge(self, evidence: Evidence) -> Finding:
        """Judge the program by the criteria of the exercise about its node: all of them have to be met."""
        return self.node.judge_as_one(self.view(evidence), "every requirement for its node is met")

    def ending(self, evidence: Evidence) -> str:
        """Return in a few words what is wrong with the program's end; empty if it ended as it should."""
        parts = self.parts(evidence)
        if self.ends_by_itself and parts:
            return _its_own_end(parts)
        for part in parts:
            pressed = part.first("subject", INTERRUPTED)
            if pressed is None:
                return "ended by itself" if part.ending else "was not reached"
            if part.ending is None:
                return "went on"
        return "" if parts else "did not run"


class _OneProgram:
    """A bench for the scenario of one program's node. It passes all other methods on to the judge's bench."""

    def __init__(self, bench: Bench, program: LabProgram) -> None:
        self._bench, self._program = bench, program
        self.built = False
        self.before = program.view(bench.before) if bench.before else None
        parts = program.parts(bench.reference.parts)
        self.reference = replace(bench.reference, parts=parts)

    def __getattr__(self, word: str) -> Any:
        return getattr(self._bench, word)

    def part(self, name: str, **inputs: Any) -> None:
        self._bench.part(f"{self._program.prefix}{name}", **inputs)

    def again(self, name: str = "") -> None:
        self._bench.again(name and f"{self._program.prefix}{name}")

    def keep(self, name: str) -> bool:
        return self._bench.keep(f"{self._program.prefix}{name}")

    def wait_until(self, condition: Callable[[Evidence], bool], within: float, **how: Any) -> bool:
        return self._bench.wait_until(lambda e: condition(self._program.view(e)), within, **how)

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        return self._bench.watch_graph(lambda e: condition(self._program.view(e)), within)

    def start(self, *arguments: Any, **options: Any) -> None:
        self._bench.start(self._program.name, *arguments, **options)
        package_mistakes.await_build(self._bench)
        report = package_mistakes.build_report(self._bench.seen())
        self.built = report is None or report.built

    def stop(self) -> None:
        self._bench.press_ctrl_c(ENDING[self._bench.pace])
        self._bench.stop()


def _before_ctrl_c(part: Part) -> Part:
    pressed = part.first("subject", INTERRUPTED)
    return part if pressed is None else replace(part, events=part.events[: part.events.index(pressed)])


def _its_own_end(parts: Sequence[Part]) -> str:
    """Return what is wrong with the end of a program that should end by itself; empty if nothing is wrong."""
    if any(part.ending is None and part.first("subject", INTERRUPTED) for part in parts):
        return "went on"
    # A program that had fallen silent counts as hung even if it ended after the judge had requested its stacks.
    if any(part.ending is None or part.of("stack") for part in parts):
        return "did not end"
    # An exception in one run is allowed: with it, a program may report that it waited in vain. But a program that
    # raised an exception in every run never did its work.
    return "failed each time" if all(_before_ctrl_c(part).traceback for part in parts) else ""


def _after_ctrl_c(part: Part) -> Part:
    return replace(part, events=part.events[len(_before_ctrl_c(part).events) :])


class Programs:
    """An exercise about several programs of a package, which the judge builds and runs one after the other.

    Args:
        programs: The programs, in the order of the task.
        keeps: The programs of an earlier lab. If the package still contains their modules, it must also have their
            entry points.
    """

    def __init__(self, name: str, *programs: LabProgram, keeps: Sequence[str] = ()) -> None:
        self._name, self._programs, self._keeps = name, programs, keeps

    def exercise(self, exercise_id: str, title: str, task: str, **more: Any) -> Exercise:
        """Return the exercise: a criterion about entry points, one for each program, and one about Ctrl-C.

        Args:
            exercise_id: The exercise's id, such as ``"lab_1_2.programs"``.
            task: One sentence that states the task.
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
                Criterion("ctrl_c", self._ends("Each program ends on Ctrl-C"), 2, self._all_end),
            ),
            mistakes=(*self._of_the_package(), *self._of_the_programs()),
            roles=tuple(dict.fromkeys(role for program in self._programs for role in program.node.roles)),
            limit=500.0,
            runner=RunsPrograms(self._name, names),
            sample_arguments=next(
                (p.node.sample_arguments for p in self._programs if p.node.sample_arguments), ()
            ),
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
        report = package_mistakes.build_report(evidence.main)
        if report is not None and not report.built:
            return Finding(False, expected, package_mistakes.seen_of_build(report))
        absent = [program.name for program in self._programs if not self._is_there(program, evidence)]
        if absent:
            return Finding(False, expected, f"it does not start {_and(absent)}")
        lost = self._lost(evidence)
        if lost:
            expected += f", and setup.py has an entry point for {_and(lost)}, too"
        return Finding(not lost, expected, f"no entry point for {_and(lost)}" if lost else "started")

    def _is_there(self, program: LabProgram, evidence: Evidence) -> bool:
        view = program.view(evidence)
        report = report_of(view.main)
        if package_mistakes.entry_point(view, self._entry(program)):
            return False
        if report is not None:
            return report.built and not report.missing
        return any(part.endpoints(role) for part in view for role in program.node.roles)

    def _entry(self, program: LabProgram) -> package_mistakes.EntryPoint:
        return package_mistakes.EntryPoint(self._name, program.name, program.file)

    def _lost(self, evidence: Evidence) -> list[str]:
        report = report_of(evidence.main)
        return [name for name in self._keeps if package_mistakes.lost_entry_point(report, self._name, name)]

    def _all_end(self, evidence: Evidence) -> Finding:
        seen = {program.name: self._ending(program, evidence) for program in self._programs}
        wrong = "; ".join(f"{name} {what}" for name, what in seen.items() if what)
        return Finding(not wrong, self._ends(f"{_and(list(seen))} end on Ctrl-C"), wrong or "ended")

    def _ending(self, program: LabProgram, evidence: Evidence) -> str:
        if program.ends_by_itself and not self._is_there(program, evidence):
            # This is checked first, because a program that did not start also has an event about its end.
            return "did not start"
        view, entry = program.view(evidence), self._entry(program)
        ending = program.ending(evidence)
        nowhere = ending and (
            package_mistakes.entry_point(view, entry) or package_mistakes.no_executable(view, entry)
        )
        return "did not start" if nowhere else ending

    def _ends(self, all_on_ctrl_c: str) -> str:
        """Return in words how the programs should end; the given text if all of them should end on Ctrl-C."""
        alone = [program.name for program in self._programs if program.ends_by_itself]
        others = [program.name for program in self._programs if not program.ends_by_itself]
        return f"{_and(others)} ends on Ctrl-C, and {_and(alone)} ends by itself" if alone else all_on_ctrl_c

    # --- mistakes ------------------------------------------------------------------------------------------------

    def _of_the_package(self) -> Iterable[Mistake]:
        yield from package_mistakes.in_package(self._name)
        for program in self._programs:
            for mistake in package_mistakes.mistakes(self._entry(program)):
                yield replace(mistake, recognize=partial(_of_the_view, mistake, program))

    def _of_the_programs(self) -> Iterable[Mistake]:
        yield Mistake("entry_point", self._another_program)
        for program in self._programs:
            late = () if program.ends_by_itself else (Mistake("ended_too_early", unfinished.ended_too_early),)
            wrong = _Wrong(program)
            for mistake in (*program.node.mistakes, *late):
                yield replace(mistake, recognize=partial(wrong.recognize, mistake))

    def _another_program(self, evidence: Evidence) -> Advice | None:
        """Return advice if a program does what another program should do, and nothing of its own task."""
        for program in self._programs:
            shown = {role for part in program.view(evidence) for role in _ROLES if part.endpoints(role)}
            for other in self._programs:
                if shown and not shown & set(program.node.roles) and shown >= set(other.node.roles):
                    entry = self._entry(program)
                    return Advice(
                        f"`ros2 run {self._name} {program.name}` starts a node that does what {other.name} should do.",
                        f"In setup.py, {entry.line} must lead to the file {entry.module}.py, and that file must "
                        "contain the right class.",
                    )
        return None

    def _traceback_at_the_end(self, evidence: Evidence) -> str:
        for program in self._programs:
            if not program.ends_by_itself and any(
                _after_ctrl_c(part).traceback for part in program.parts(evidence)
            ):
                return (
                    f"{program.name} ends on Ctrl-C with a traceback. Catch KeyboardInterrupt and "
                    "ExternalShutdownException around rclpy.spin, and end with rclpy.try_shutdown()."
                )
        return ""


def _of_the_view(mistake: Mistake, program: LabProgram, evidence: Evidence) -> Advice | None:
    return mistake.recognize(program.view(evidence))


class _Wrong:
    """Recognizes mistakes in a program that fails its criterion.

    Whether the program fails is decided once and stored, because a decision may take a tenth of a second. There are
    about a hundred mistakes, and the judge has only a few seconds for all of them.
    """

    def __init__(self, program: LabProgram) -> None:
        self._program = program
        self._known: tuple[Evidence | None, Evidence | None] = None, None

    def _view(self, evidence: Evidence) -> Evidence | None:
        if self._known[0] is not evidence:
            right = self._program.judge(evidence).passed and not self._program.ending(evidence)
            self._known = evidence, None if right else self._program.view(evidence)
        return self._known[1]

    def recognize(self, mistake: Mistake, evidence: Evidence) -> Advice | None:
        """Return the advice on a mistake if this program fails its criterion and shows the mistake."""
        view = self._view(evidence)
        advice = mistake.recognize(view) if view else None
        return replace(advice, text=f"{self._program.name}: {advice.text}") if advice else None


def _and(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
