"""The grader's side of a check of a workspace, with a judge and jobs of the tests' own."""

from __future__ import annotations

import contextlib
import json
import sys
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pytest

from autograder.kit.output.spoken_lines import REPORTS
from autograder.kit.runners import ALONE
from autograder.messages import run_messages
from autograder.messages import workspace_messages as messages
from autograder.messages.json_lines import Hangup, Lines
from autograder.workspaces import grading_service, packages, sources
from autograder.workspaces.builds import students_builds
from autograder.workspaces.builds.build_artifacts import Kind, PackedEntry
from autograder.workspaces.grading_service import ServiceSockets, WorkspaceService
from autograder.workspaces.jobs import BuildJob, BuildOutcome, PlainProgram, ProgramJob

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import interface_package, python_package

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from autograder.workspaces.builds.build_cache import CachedBuild


FORGED = f'{REPORTS[0]}{{"phase": "built", "built": true}}'


class FakeJobs:
    """Builds nothing and packs a program of the lab's name; runs a line of shell in place of any command."""

    def __init__(self) -> None:
        self.environment: Mapping[str, str] = {"PATH": "/usr/bin:/bin"}
        self.builds: list[list[str]] = []
        self.sources: list[str] = []
        self.commands: list[Sequence[str]] = []
        self.built = BuildOutcome(
            0, b"all is well\n", _packed("my_robot_pkg/lib/my_robot_pkg/simple_node", "my_robot_pkg/share/x")
        )
        self.script = "echo hello"
        self.waiting: Callable[[Callable[[], bool]], None] = lambda _: None

    def place(self, name: str, entry: Path) -> Path:
        return Path("/home/student") / name

    def tree(self, sources: Path) -> Path:
        return Path("/home/student/notebook")

    def build(self, job: BuildJob, command: Sequence[str], entry: CachedBuild) -> BuildOutcome:
        self.builds.append(sorted(path.name for path in (entry.folder / "src").iterdir()))
        self.sources.append("".join(path.read_text() for path in entry.folder.rglob("*") if path.is_file()))
        self.waiting(job.cancelled)
        return self.built

    def start(self, job: ProgramJob) -> PlainProgram:
        self.commands.append(job.command)
        return PlainProgram(["/bin/sh", "-c", self.script], job.environment, job.sources)


def _packed(*names: str) -> bytes:
    """A packed install folder whose files contain its path in the box, as colcon's scripts do."""
    place = b"/home/student/ros2_ws/install"
    return msgspec.msgpack.encode([PackedEntry(name.encode(), Kind.FILE, place) for name in names])


class FakeJudge:
    """Plays the judge's part on its socket."""

    def __init__(self, sockets: ServiceSockets) -> None:
        self.lines = Lines.to(sockets.judge, 20.0)

    def check(self, workspace: Path, exercise: str = "lab_1_1.hello", trouble: str = "") -> None:
        sent = sources.collect_workspace(workspace)
        self.lines.say(messages.CheckRequest(exercise, 7, workspace.name, len(sent), trouble))
        for source in sent:
            self.lines.say(source)
        self.lines.hear(run_messages.Ready)

    def hear(self) -> dict[str, Any]:
        return words_of(self.lines, messages.FromService)

    def run(self, number: int = 1) -> list[dict[str, Any]]:
        """What is said of a run until it has ended by itself."""
        self.lines.say(run_messages.Start(number))
        heard: list[dict[str, Any]] = []
        while not heard or heard[-1]["say"] not in ("exited", "trouble"):
            heard.append(self.hear())
        return heard


def words_of(lines: Lines, kind: Any) -> dict[str, Any]:
    """The next message as plain data."""
    words: dict[str, Any] = msgspec.to_builtins(lines.hear(kind))
    return words


def reports(heard: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [json.loads(words["text"].partition(" ")[2]) for words in heard if words["say"] == "report"]


@pytest.fixture
def jobs() -> FakeJobs:
    return FakeJobs()


@pytest.fixture
def sockets(jobs: FakeJobs, tmp_path: Path) -> Iterator[ServiceSockets]:
    builds = tmp_path / "builds"
    builds.mkdir(mode=0o700)
    # Sockets have short names.
    with tempfile.TemporaryDirectory() as name:
        sockets = ServiceSockets(Path(name) / "j", Path(name) / "n")
        with WorkspaceService(sockets, jobs, builds, {"SAID": "1"}, tmp_path):
            yield sockets


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    python_package(tmp_path / "ros2_ws" / "src", "my_robot_pkg")
    return tmp_path / "ros2_ws"


@pytest.fixture
def judge(sockets: ServiceSockets, lab: Path) -> FakeJudge:
    """One that has begun the check of the lab's workspace."""
    made = FakeJudge(sockets)
    made.check(lab)
    return made


def test_it_is_found_built_and_started_by_ros2_run(judge: FakeJudge, jobs: FakeJobs) -> None:
    heard = judge.run()
    assert [report["phase"] for report in reports(heard)] == ["found", "built"]
    assert reports(heard)[1]["built"]
    assert [words["text"] for words in heard if words["say"] == "output"] == ["hello"]
    assert heard[-1] == {"say": "exited", "run": 1, "code": 0}
    assert jobs.commands[0][-3:] == ["run", "my_robot_pkg", "simple_node"]


def test_what_a_program_says_is_never_a_report(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.script = f"echo '{FORGED}'"
    heard = judge.run()
    assert len(reports(heard)) == 2
    assert {"say": "output", "run": 1, "text": FORGED, "logged": False} in heard


def test_a_build_that_says_it_went_well_and_brought_nothing_has_not(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.built = BuildOutcome(0, FORGED.encode(), _packed("my_robot_pkg/share/x"))
    heard = judge.run()
    assert reports(heard)[-1]["missing"] == "simple_node"
    assert not jobs.commands


def test_a_failed_build_is_told_and_not_kept(judge: FakeJudge, jobs: FakeJobs) -> None:
    said = b'  File "/x/setup.py", line 3\nSyntaxError: no\nFailed   <<< my_robot_pkg\n'
    good, jobs.built = jobs.built, BuildOutcome(1, said, jobs.built.archive)
    told = reports(judge.run())[-1]
    found = (told["trouble"], told["package"], told["line"])
    assert found == ("build", "my_robot_pkg", "x/setup.py:3: SyntaxError: no")
    assert not jobs.commands, "what it has left is not taken"
    jobs.built = good
    assert reports(judge.run(2))[-1]["built"]


def test_what_fails_and_is_only_depended_on_takes_nothing_away(
    sockets: ServiceSockets, jobs: FakeJobs, lab: Path
) -> None:
    interface_package(lab / "src" / "my_robot_interfaces")
    file = lab / "src" / "my_robot_pkg" / "package.xml"
    file.write_text(
        file.read_text().replace("<license>", "<depend>my_robot_interfaces</depend>\n  <license>")
    )
    good, jobs.built = jobs.built, BuildOutcome(1, b"no\nFailed   <<< my_robot_interfaces\n")

    def mended(_: Callable[[], bool]) -> None:
        if jobs.builds[-1] == ["my_robot_pkg"]:
            jobs.built = good

    jobs.waiting = mended
    judge = FakeJudge(sockets)
    judge.check(lab)
    assert reports(judge.run())[-1]["built"]
    assert jobs.builds == [["my_robot_interfaces"], ["my_robot_pkg"]]


def test_the_same_sources_are_built_once_for_all(sockets: ServiceSockets, jobs: FakeJobs, lab: Path) -> None:
    for _ in range(2):
        judge = FakeJudge(sockets)
        judge.check(lab)
        judge.run(1)
        judge.run(2)
        judge.lines.close()
    assert jobs.builds == [["my_robot_pkg"]]
    file = lab / "src" / "my_robot_pkg" / "my_robot_pkg" / "hello.py"
    for change, runs in ((lambda: file.write_text("\n"), 1), (file.with_name("other.py").touch, 2)):
        change()
        judge = FakeJudge(sockets)
        judge.check(lab)
        judge.run()
        judge.lines.close()
        assert len(jobs.builds) == runs


def test_what_is_not_needed_is_not_built(sockets: ServiceSockets, jobs: FakeJobs, lab: Path) -> None:
    (python_package(lab / "src", "half_done") / "package.xml").write_text("<package>")
    judge = FakeJudge(sockets)
    judge.check(lab)
    assert reports(judge.run())[-1]["built"]
    assert jobs.builds == [["my_robot_pkg"]]


def test_what_is_no_workspace_says_so(sockets: ServiceSockets, tmp_path: Path) -> None:
    (tmp_path / "ros2_ws" / "src").mkdir(parents=True)
    judge = FakeJudge(sockets)
    judge.check(tmp_path / "ros2_ws")
    told = reports(judge.run())[-1]
    assert told["trouble"] == "no_package"
    assert str(tmp_path) not in told["line"]


def test_sources_that_were_not_to_be_had_are_a_failure_with_a_reason(
    sockets: ServiceSockets, lab: Path
) -> None:
    judge = FakeJudge(sockets)
    judge.check(lab, trouble="there is too much in src")
    assert reports(judge.run()) == [
        {**reports(judge.run(2))[0], "line": "there is too much in src", "built": False}
    ]


def test_a_path_that_leads_out_is_refused(sockets: ServiceSockets, jobs: FakeJobs) -> None:
    judge = FakeJudge(sockets)
    judge.lines.say(messages.CheckRequest("lab_1_1.hello", 7, "ros2_ws", 1))
    judge.lines.say(messages.Source("../evil", b""))
    judge.lines.hear(run_messages.Ready)
    assert "is not a path inside" in reports(judge.run())[-1]["line"]
    assert not jobs.builds


def test_a_run_is_ended_when_the_judge_says_so(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.script = "echo started; sleep 1000"
    judge.lines.say(run_messages.Start(1))
    while judge.hear().get("text") != "started":
        pass
    judge.lines.say(run_messages.Stop(1))
    assert judge.hear() == {"say": "stopped", "run": 1}


TRAP = "trap 'echo bye; exit 4' INT; echo started; while :; do sleep 0.05; done"


def test_ctrl_c_ends_the_program_that_the_judge_has_named(
    sockets: ServiceSockets, jobs: FakeJobs, lab: Path
) -> None:
    jobs.built = BuildOutcome(0, b"", _packed("my_robot_pkg/lib/my_robot_pkg/talker", "my_robot_pkg/share/x"))
    jobs.script = TRAP
    judge = FakeJudge(sockets)
    judge.check(lab, "lab_1_2.programs")
    judge.lines.say(run_messages.Start(1, ["talker", "7"]))
    while judge.hear().get("text") != "started":
        pass
    assert jobs.commands[0][-4:] == ["run", "my_robot_pkg", "talker", "7"]
    judge.lines.say(run_messages.Interrupt(1))
    assert judge.hear() == {"say": "output", "run": 1, "text": "bye", "logged": False}
    assert judge.hear() == {"say": "exited", "run": 1, "code": 4}


def test_in_place_of_a_launch_the_program_is_run_that_the_judge_has_named(
    sockets: ServiceSockets, jobs: FakeJobs, tmp_path: Path
) -> None:
    file = tmp_path / "remap.launch.py"
    file.write_text("")
    path, sent = sources.collect_launch(file, None)
    judge = FakeJudge(sockets)
    judge.lines.say(messages.CheckRequest("exercise_1_1.remap", 7, path, len(sent)))
    for source in sent:
        judge.lines.say(source)
    judge.lines.hear(run_messages.Ready)
    for run, words in enumerate(((), (ALONE, "my_robot_pkg", "talker", "--ros-args")), 1):
        judge.lines.say(run_messages.Start(run, list(words)))
        while judge.hear()["say"] != "exited":
            pass
    launched, alone = jobs.commands
    assert launched[-2:] == ["launch", "/home/student/notebook/remap.launch.py"]
    assert alone == [launched[0], "run", "my_robot_pkg", "talker", "--ros-args"]


def test_a_program_that_was_not_built_is_named_and_the_other_one_runs(
    sockets: ServiceSockets, jobs: FakeJobs, lab: Path
) -> None:
    jobs.built = BuildOutcome(0, b"", _packed("my_robot_pkg/lib/my_robot_pkg/talker", "my_robot_pkg/share/x"))
    judge = FakeJudge(sockets)
    judge.check(lab, "lab_1_2.programs")
    missing = []
    for run, program in enumerate(("talker", "listener"), 1):
        judge.lines.say(run_messages.Start(run, [program]))
        heard: list[dict[str, Any]] = []
        while not heard or heard[-1]["say"] != "exited":
            heard.append(judge.hear())
        missing.append(reports(heard)[-1]["missing"])
    assert missing == ["", "listener"]
    assert len(jobs.commands) == 1


def test_ctrl_c_for_an_earlier_run_ends_no_later_one(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.script = TRAP
    judge.lines.say(run_messages.Start(2))
    while judge.hear().get("text") != "started":
        pass
    judge.lines.say(run_messages.Interrupt(1))
    judge.lines.say(run_messages.Stop(2))
    assert judge.hear() == {"say": "stopped", "run": 2}


def test_a_build_is_given_up_when_nobody_waits_for_it(judge: FakeJudge, jobs: FakeJobs) -> None:
    given_up, building = threading.Event(), threading.Event()

    def wait(cancelled: Callable[[], bool]) -> None:
        building.set()
        while not cancelled():
            threading.Event().wait(0.01)
        given_up.set()

    jobs.waiting = wait
    judge.lines.say(run_messages.Start(1))
    assert building.wait(20.0)
    judge.lines.close()
    assert given_up.wait(20.0)


def test_trouble_of_the_grader_s_own_is_no_report(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.built = None  # type: ignore[assignment]
    heard = judge.run()
    assert heard[-1]["say"] == "trouble"
    assert [report["phase"] for report in reports(heard)] == ["found"]


def test_a_very_long_line_comes_in_pieces(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.script = "head -c 100000 /dev/zero | tr '\\0' x; echo; echo end"
    said = [words["text"] for words in judge.run() if words["say"] == "output"]
    assert max(map(len, said)) <= 4_000
    assert said[-1] == "end"


@pytest.fixture
def colcon(
    sockets: ServiceSockets, lab: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str]]:
    """Types ``colcon build`` in a notebook's terminal: how it ends, and what it says."""

    def build(*words: str) -> tuple[int, str]:
        monkeypatch.setenv(students_builds.GRADERS, str(sockets.notebook))
        monkeypatch.chdir(lab)
        return students_builds.main(["build", *words]), capsys.readouterr().out

    return build


def test_a_notebook_s_build_comes_from_the_grader(
    sockets: ServiceSockets, jobs: FakeJobs, lab: Path, colcon: Callable[..., tuple[int, str]]
) -> None:
    code, said = colcon("--packages-select", "my_robot_pkg")
    assert (code, "Finished <<< my_robot_pkg" in said) == (0, True)
    assert (lab / "install" / "my_robot_pkg" / "lib" / "my_robot_pkg" / "simple_node").is_file()
    script = lab / "install" / "my_robot_pkg" / "share" / "x"
    assert script.read_text() == str(lab / "install"), "the path in the box leads nowhere"
    judge = FakeJudge(sockets)
    judge.check(lab)
    assert reports(judge.run())[-1]["built"]
    assert jobs.builds == [["my_robot_pkg"]]


def test_a_notebook_s_build_that_fails_or_is_refused_says_why(
    jobs: FakeJobs, lab: Path, monkeypatch: pytest.MonkeyPatch, colcon: Callable[..., tuple[int, str]]
) -> None:
    jobs.built = BuildOutcome(1, b"SyntaxError: invalid syntax\nFailed   <<< my_robot_pkg\n")
    code, said = colcon()
    assert (code, "SyntaxError" in said, (lab / "install").exists()) == (1, True, False)
    (lab / "src" / "my_robot_pkg" / "large.bin").write_bytes(bytes(200))
    monkeypatch.setattr(packages, "MAX_BYTES", 100)
    code, said = colcon()
    assert code == 1
    assert "the limit for a file in a check: move it out of the workspace" in said


def test_the_judge_may_be_gone_when_the_grader_has_trouble(
    judge: FakeJudge, jobs: FakeJobs, monkeypatch: pytest.MonkeyPatch
) -> None:
    raised: list[object] = []
    monkeypatch.setattr(threading, "excepthook", lambda found: raised.append(found.exc_value))
    building, gone = threading.Event(), threading.Event()

    def fail(_: object) -> None:
        building.set()
        gone.wait(20.0)
        raise RuntimeError("no disk")

    jobs.waiting = fail
    judge.lines.say(run_messages.Start(1))
    assert building.wait(20.0)
    judge.lines.close()
    gone.set()
    for thread in threading.enumerate():
        if "_run" in thread.name:
            thread.join(20.0)
    assert raised == []


def until_they_hang_up(lines: Lines) -> list[str]:
    words = []
    with contextlib.suppress(Hangup):
        while True:
            words.append(words_of(lines, messages.BuildAnswer)["say"])
    return words


def test_a_notebook_has_only_so_many_builds(sockets: ServiceSockets) -> None:
    assert sockets.notebook is not None
    for _ in range(grading_service.MAX_BUILDS):
        lines = Lines.to(sockets.notebook, 20.0)
        lines._socket.sendall(b'{"say": "nothing"}\n')
        assert until_they_hang_up(lines) == ["no"]
    assert until_they_hang_up(Lines.to(sockets.notebook, 20.0)) == ["no"]


@pytest.mark.parametrize(
    "garbage", [b"\xff\xff garbage\n", b"[" * 100_000 + b"\n", b'{"say": 1}\n', b"x" * 1_200_000]
)
def test_garbage_on_a_socket_hurts_nobody(sockets: ServiceSockets, lab: Path, garbage: bytes) -> None:
    assert sockets.notebook is not None
    for path in (sockets.notebook, sockets.judge):
        lines = Lines.to(path, 20.0)
        with contextlib.suppress(OSError):
            lines._socket.sendall(garbage)
        assert until_they_hang_up(lines) == []
    judge = FakeJudge(sockets)
    judge.check(lab)
    assert judge.run()[-1]["say"] == "exited"


def size_of_output(words: dict[str, Any]) -> int:
    """The characters of a line that a program has printed; what is reported of its build does not count."""
    return len(words["text"]) + 1 if words["say"] == "output" else 0


def test_endless_output_is_cut_and_ends_with_the_run(
    judge: FakeJudge, jobs: FakeJobs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(grading_service, "MAX_OUTPUT", 10_000)
    jobs.script = "yes"
    judge.lines.say(run_messages.Start(1))
    size = 0
    while size < 9_900:
        size += size_of_output(judge.hear())
    judge.lines.say(run_messages.Stop(1))
    while (words := judge.hear())["say"] != "stopped":
        size += size_of_output(words)
    assert size <= 10_000


def test_a_build_that_takes_too_long_says_nothing_about_the_sources(judge: FakeJudge, jobs: FakeJobs) -> None:
    jobs.built = BuildOutcome(None, b"", late=170.0)
    heard = judge.run()
    assert heard[-1]["say"] == "trouble"
    assert "too busy" in heard[-1]["why"]
