"""What is told of the programs of a package: whose run it is, what came before Ctrl-C, and where files lie."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from unittest.mock import MagicMock

import pytest

from autograder.judge.verdicts import deciding
from autograder.kit.evidence import INTERRUPTED, Event, Evidence, Part, Reference
from autograder.kit.mistakes import package_mistakes
from autograder.kit.mistakes.package_mistakes import EntryPoint
from autograder.kit.model import Advice, Criterion, Exercise, Finding, Mistake
from autograder.kit.output.workspace_reports import PackageReport, WorkspaceReport, workspace_report_line
from autograder.kit.recipes.programs import LabProgram, Programs
from tests.cases import cases

if TYPE_CHECKING:
    from autograder.kit.bench import Bench

PACKAGE = "my_robot_pkg"
TRACEBACK = ("Traceback (most recent call last):", '  File "a.py", line 1, in main', "KeyboardInterrupt")


def said(text: str) -> Event:
    return Event(0.0, "output", "stderr", {"text": text})


def subject(name: str) -> Event:
    return Event(0.0, "subject", name)


def says_hello(evidence: Evidence) -> Finding:
    return Finding("hello" in evidence.main.said(), "hello", ", ".join(evidence.main.said()))


NODE = Exercise(
    "lab_9_1.node", "", "", lambda _: None, (Criterion("hello", "", 10, says_hello),), (), ("publisher",)
)
TALKER, LISTENER = LabProgram("talker", NODE, "", 3), LabProgram("listener", NODE, "", 3)
PROGRAMS = Programs(PACKAGE, TALKER, LISTENER, keeps=("simple_node",)).exercise("lab_9_1.programs", "", "")


def evidence(talker: list[Event], listener: list[Event] | None = None) -> Evidence:
    parts = [Part("talker: talking", {}, talker)]
    if listener is not None:
        parts.append(Part("listener: listening", {}, listener))
    return Evidence(parts, Reference("lab_9_1.programs", {}))


def test_a_program_is_judged_by_its_own_runs_and_by_what_came_before_ctrl_c() -> None:
    seen = evidence([said("hello"), subject(INTERRUPTED), said("bye"), subject("exited")], [said("nothing")])
    view = TALKER.view(seen)
    assert [part.name for part in view] == ["talking"]
    assert view.main.said() == ["hello"]
    assert view.main.ending is None
    assert TALKER.judge(seen).passed
    assert not LISTENER.judge(seen).passed
    assert LISTENER.judge(seen).seen == "nothing"


@pytest.mark.parametrize(
    ("events", "what"),
    [
        ([said("hello"), subject(INTERRUPTED), subject("exited")], ""),
        ([said("hello"), subject(INTERRUPTED)], "went on"),
        ([said("hello"), subject("exited")], "ended by itself"),
        ([], "was not reached"),
    ],
)
def test_only_ctrl_c_is_the_right_end(events: list[Event], what: str) -> None:
    assert TALKER.ending(evidence(events)) == what
    assert LISTENER.ending(evidence(events)) == "did not run"


def test_whether_a_program_is_right_is_decided_once_for_all_its_mistakes() -> None:
    asked: list[Evidence] = []

    def never(evidence: Evidence) -> Finding:
        asked.append(evidence)
        return Finding(False, "", "")

    def advice(evidence: Evidence) -> Advice:
        return Advice(evidence.main.said()[0], "")

    known = (*(Mistake(f"none_{number}", lambda _: None) for number in range(50)), Mistake("last", advice))
    node = replace(NODE, criteria=(Criterion("never", "", 10, never),), mistakes=known)
    exercise = Programs(PACKAGE, LabProgram("talker", node, "", 3)).exercise("lab_9_1.programs", "", "")
    for word in ("one", "other"):
        asked.clear()
        seen = evidence([said(word)])
        told = [found.text for mistake in exercise.mistakes if (found := mistake.recognize(seen))]
        assert told == [f"talker: {word}"]
        assert len(asked) == 1


CLIENT = LabProgram("asker", NODE, "", 3, file="asking", ends_by_itself=True)
BOTH = Programs(PACKAGE, TALKER, CLIENT).exercise("lab_9_1.programs", "", "")
HANGS = Event(0.0, "stack", "subject", {"text": ""})
CRASH = [*map(said, TRACEBACK), subject("exited")]


@pytest.mark.parametrize(
    ("runs", "what"),
    [
        ([[said("hello"), subject("exited")]], ""),
        ([[said("hello"), subject(INTERRUPTED), subject("exited")]], ""),
        ([[said("hello"), subject("exited")], CRASH], ""),
        ([CRASH, CRASH], "failed each time"),
        ([[said("hello"), subject("exited")], [subject(INTERRUPTED)]], "went on"),
        ([[HANGS, subject("aborted")]], "did not end"),
        ([[HANGS, subject(INTERRUPTED), subject("exited")]], "did not end"),
        ([], "did not run"),
    ],
)
def test_a_client_comes_to_its_own_end_or_ends_on_ctrl_c(runs: list[list[Event]], what: str) -> None:
    parts = [Part(f"asker: run {number}", {}, events) for number, events in enumerate(runs)]
    assert CLIENT.ending(Evidence(parts, Reference("lab_9_1.programs", {}))) == what


def test_a_client_that_was_never_there_has_not_ended() -> None:
    lines = [
        said(workspace_report_line(report("my_robot_pkg/asking.py", missing="asker"))),
        subject("exited"),
    ]
    ended = [
        said(workspace_report_line(report("my_robot_pkg/talker.py"))),
        subject(INTERRUPTED),
        subject("exited"),
    ]
    seen = Evidence(
        [Part("talker: talking", {}, ended), Part("asker: asking", {}, lines)],
        Reference("lab_9_1.programs", {}),
    )
    finding = BOTH.criteria[-1].judge(seen)
    assert (finding.passed, finding.seen) == (False, "asker did not start")
    assert BOTH.criteria[-1].title == "talker ends on Ctrl-C, and asker ends by itself"


def test_a_program_without_an_entry_point_did_not_start() -> None:
    lines = [
        said(workspace_report_line(report("my_robot_pkg/asking.py", missing="talker"))),
        subject("exited"),
    ]
    finding = BOTH.criteria[-1].judge(evidence(lines))
    assert (finding.passed, finding.seen) == (False, "talker did not start; asker did not start")


def test_a_traceback_after_ctrl_c_costs_nothing_and_is_worth_a_word() -> None:
    quiet = [said("hello"), subject(INTERRUPTED), subject("exited")]
    loud = [said("hello"), subject(INTERRUPTED), *map(said, TRACEBACK), subject("exited")]
    (remark,) = PROGRAMS.remarks
    assert remark(evidence(quiet, quiet)) == ""
    assert remark(evidence(quiet, loud)).startswith("listener ends on Ctrl-C with a traceback.")
    assert PROGRAMS.criteria[-1].judge(evidence(quiet, loud)).passed
    assert [mistake.key for mistake in PROGRAMS.mistakes if mistake.recognize(evidence(quiet, loud))] == []


def report(*modules: str, programs: tuple[str, ...] = (), missing: str = "") -> WorkspaceReport:
    package = PackageReport(PACKAGE, "ament_python", programs, (), (), modules)
    return WorkspaceReport("built", built=True, packages=(package,), missing=missing)


ENTRY = "talker = my_robot_pkg.talker:main"


@pytest.mark.parametrize(
    ("module", "programs", "installed", "lost"),
    cases(__file__, "an_entry_point_is_lost_where_its_module_is_there_and_nothing_starts_it"),
)
def test_an_entry_point_is_lost_where_its_module_is_there_and_nothing_starts_it(
    module: str, programs: tuple[str, ...], installed: tuple[str, ...], lost: bool
) -> None:
    made = report(f"my_robot_pkg/{module}.py", programs=programs)
    made = replace(made, packages=[replace(made.packages[0], installed=installed)])
    assert package_mistakes.lost_entry_point(made, PACKAGE, "simple_node") is lost


@pytest.mark.parametrize(
    ("modules", "programs", "wrong"), cases(__file__, "a_file_in_another_folder_is_found")
)
def test_a_file_in_another_folder_is_found(
    modules: tuple[str, ...], programs: tuple[str, ...], wrong: str
) -> None:
    seen = evidence([said(workspace_report_line(report(*modules, programs=programs)))])
    advice = package_mistakes.wrong_folder(seen, EntryPoint(PACKAGE, "talker"))
    assert (advice is not None) == bool(wrong)
    assert advice is None or wrong in advice.text


LOADING = (
    "Traceback (most recent call last):",
    '  File "/ws/install/my_robot_pkg/lib/my_robot_pkg/talker", line 33, in <module>',
    "    sys.exit(load_entry_point('my-robot-pkg==0.0.0', 'console_scripts', 'talker')())",
    '  File "/ws/install/my_robot_pkg/lib/my_robot_pkg/talker", line 25, in importlib_load_entry_point',
    "    return next(matches).load()",
    "           ^^^^^^^^^^^^^^^^^^^^",
    '  File "/usr/lib/python3.12/importlib/metadata/__init__.py", line 205, in load',
    "    module = import_module(match.group('module'))",
    '  File "<frozen importlib._bootstrap>", line 1324, in _find_and_load_unlocked',
)
OWN_IMPORT = (
    '  File "/ws/install/my_robot_pkg/lib/python3.12/site-packages/my_robot_pkg/talker.py", line 1, in <module>',
    "    import helper",
)


@pytest.mark.parametrize(
    ("lines", "missing", "named"),
    [
        (LOADING, "my_robot_pakage", "points to the module my_robot_pakage, which does not exist"),
        (LOADING, "my_robot_pkg", ""),
        (LOADING, "my_robot_pkg.tlaker", "points to the module my_robot_pkg.tlaker, which does not exist"),
        ((*LOADING, *OWN_IMPORT), "helper", ""),
        ((*LOADING, *OWN_IMPORT), "my_robot_pkg.helpers", ""),
    ],
)
def test_an_entry_point_that_leads_nowhere_is_told_from_an_import(
    lines: tuple[str, ...], missing: str, named: str
) -> None:
    seen = evidence([*map(said, lines), said(f"ModuleNotFoundError: No module named '{missing}'")])
    advice = package_mistakes.entry_point(seen, EntryPoint(PACKAGE, "talker"))
    assert (advice is not None) == bool(named)
    assert advice is None or named in advice.text


@pytest.mark.parametrize("built", [True, False])
def test_the_card_names_what_was_changed_since_the_last_build(built: bool) -> None:
    report = WorkspaceReport("built", built=built, trouble="" if built else "build", changed="`a/setup.py`")
    (remark,) = deciding.judge(PROGRAMS, evidence([said(workspace_report_line(report))]), "").remarks
    assert remark.startswith("Changed since the last `colcon build`: `a/setup.py`.")


def test_nothing_is_said_of_a_build_that_is_not_the_students(subtests: pytest.Subtests) -> None:
    for exercise, changed in ((PROGRAMS, ""), (NODE, "`a/setup.py`")):
        with subtests.test(exercise.id):
            report = workspace_report_line(WorkspaceReport("built", built=True, changed=changed))
            assert deciding.judge(exercise, evidence([said(report)]), "").remarks == ()


def test_a_run_that_is_made_again_is_one_of_the_same_program() -> None:
    def scenario(bench: Bench) -> None:
        bench.again("talking")
        bench.again()

    bench = MagicMock(before=None, reference=Reference("lab_9_1.programs", {}))
    program = LabProgram("talker", replace(NODE, scenario=scenario), "", 3)
    Programs(PACKAGE, program).exercise("lab_9_1.programs", "", "").scenario(bench)
    assert [call.args for call in bench.again.mock_calls] == [("talker: talking",), ("",)]
