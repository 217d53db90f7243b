"""The autograder command: what it prints and with which exit code it ends."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import nullcontext
from pathlib import Path

import pytest
from click.testing import CliRunner

from autograder import check_journal
from autograder.authoring.answer_bank import answers_folder
from autograder.boxes.sandbox import why_impossible
from autograder.cli import GROUPS, cli, student_commands
from autograder.cli.student_commands import show
from autograder.judge import command_check
from autograder.kit.reported_texts import AT_PACE
from autograder.student.lab import NOTEBOOKS_VARIABLE
from autograder.verdict import State, Verdict, not_checked
from course_runtime.python_child import SAFE_PATH, TYPED_PYTHONPATH, installed_program
from tests.cases import cases, named_cases
from tests.measure.bank import answer_named

TALKER = answers_folder("lab_1_2.talker")
LISTENER = answers_folder("lab_1_2.listener")


def wrong_talker(name: str, folder: Path) -> str:
    """A wrong answer of the bank as a file."""
    return answer_named(f"lab_1_2.talker/wrong/{name}").unpack(folder)[-1]


def _run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words], capture_output=True, text=True, check=False, timeout=120
    )


def test_the_help_lists_each_command_once_with_a_whole_sentence() -> None:
    said = _run("--help").stdout
    assert "..." not in said.partition("Options:")[2]
    assert said.index("Students:") < said.index("Instructors, a class:") < said.index("Authors:")
    listed = [line.split()[0] for line in said.split("Students:")[1].splitlines() if line[:3].strip()]
    assert [name for name in listed if name[0].islower()] == [
        str(command.name) for commands in GROUPS.values() for command in commands
    ]


def test_check_alone_lists_the_exercises() -> None:
    done = _run("check")
    assert done.returncode == 0
    assert "lab_1_2.talker" in done.stdout


@pytest.mark.parametrize(("words", "hint"), named_cases(__file__, "bad_input_is_named_and_ends_with_2"))
def test_bad_input_is_named_and_ends_with_2(words: tuple[str, ...], hint: str) -> None:
    done = _run(*words)
    assert done.returncode == 2
    assert hint in done.stderr
    assert "Traceback" not in done.stderr


NO_BOX = pytest.mark.skipif(bool(why_impossible()), reason=f"no boxes here: {why_impossible()}")


def _boxed(folder: Path, *command: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "autograder", "check", "lab_1_2.talker", "--box", "--json", "--", *command],
        capture_output=True, text=True, check=False, timeout=120, cwd=folder, env={**os.environ, **variables},
    )  # fmt: skip


@NO_BOX
@pytest.mark.ros
def test_in_a_box_a_program_has_the_same_verdict_and_sees_its_folder_only(tmp_path: Path) -> None:
    shutil.copy(TALKER / "right" / "text_as_it_stands.py", tmp_path / "talker.py")
    assert json.loads(_boxed(tmp_path, "python3", "talker.py").stdout)["state"] == "passed"
    secret = tmp_path.parent / "secret_of_somebody_else"
    secret.touch()
    workspace = tmp_path.parent / "reference_ws"
    (workspace / "share" / "ament_index").mkdir(parents=True)
    (tmp_path / "talker.py").write_text(f"""
import os, pathlib, socket
started = [path.read_text() for path in pathlib.Path("/proc").glob("[0-9]*/environ")]
found = [
    os.path.exists({str(secret)!r}), os.path.exists({str(TALKER)!r}), os.path.exists({str(workspace)!r}),
    [text for text in (*started, str(os.environ)) if "planted" in text or "reference_ws" in text],
    [name for _, name in socket.if_nameindex()], os.access(".", os.W_OK), os.listdir(),
]
raise RuntimeError(f"it sees {{found}}")
""")
    sourced = {"AMENT_PREFIX_PATH": str(workspace), "PYTHONPATH": str(workspace)}
    done = _boxed(tmp_path, "python3", "talker.py", SECRET="planted", ROS_SECRET="planted", **sourced)
    assert done.returncode == 1
    assert "it sees [False, False, False, [], ['lo'], False, ['talker.py']]" in done.stdout
    assert not list(Path(tempfile.gettempdir()).glob("autograder-box-*/scratch"))


@NO_BOX
@pytest.mark.parametrize(
    ("folder", "command", "hint"),
    [
        (Path.home(), ["true"], "must not see"),
        (TALKER, ["python3", "../listener.answers/right/text_as_it_stands.py"], "is not in"),
    ],
)
def test_what_a_box_cannot_show_is_said(folder: Path, command: list[str], hint: str) -> None:
    done = _boxed(folder, *command)
    assert done.returncode == 2
    assert hint in done.stderr


def test_where_no_box_is_possible_nothing_is_run(tmp_path: Path) -> None:
    nothing = tmp_path / "bin"
    nothing.mkdir()
    done = _boxed(tmp_path, "/bin/sh", "-c", "touch it_ran", PATH=str(nothing))
    assert done.returncode == 2
    assert "no sandbox is possible here: bubblewrap is not installed" in done.stderr
    assert not (tmp_path / "it_ran").exists()


@pytest.mark.ros
def test_a_right_answer_ends_with_0_and_a_wrong_one_with_1(tmp_path: Path) -> None:
    right = _run(
        "check", "lab_1_2.talker", "--", sys.executable, str(TALKER / "right" / "text_as_it_stands.py")
    )
    wrong = _run("check", "lab_1_2.talker", "--", sys.executable, wrong_talker("topic_name.py", tmp_path))
    assert (right.returncode, wrong.returncode) == (0, 1)
    assert "/chater" in wrong.stdout


@pytest.mark.parametrize(
    ("typed_in", "words", "counts"),
    [
        *cases(__file__, "only_a_program_of_the_students_folder_earns_progress"),
        ("elsewhere", (sys.executable, "../mine/talker.py"), True),
    ],
)
def test_only_a_program_of_the_students_folder_earns_progress(
    typed_in: str, words: tuple[str, ...], counts: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("mine/talker.py", "elsewhere/solution.py"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).touch()
    monkeypatch.setenv(NOTEBOOKS_VARIABLE, str(tmp_path / "mine"))
    monkeypatch.chdir(tmp_path / typed_in)
    assert student_commands._is_students(words) is counts


@pytest.mark.parametrize(("options", "notes"), [((), 1), (("--box",), 0)])
def test_a_check_in_a_box_is_no_progress(
    options: tuple[str, ...], notes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    noted: list[Verdict] = []
    verdict = Verdict("lab_1_2.talker", "Talker", State.PASSED, 10.0, 10.0)
    monkeypatch.setattr(command_check, "check_and_keep", lambda *_, **__: (verdict, None))
    monkeypatch.setattr(student_commands, "_box", lambda *_: nullcontext())
    monkeypatch.setattr(student_commands, "_is_students", lambda _: True)
    monkeypatch.setattr(check_journal, "note_check", noted.append)
    done = CliRunner().invoke(cli, ["check", *options, "lab_1_2.talker", "--", "true"])
    assert (done.exit_code, noted) == (0, [verdict] * notes)


@pytest.mark.ros
def test_json_is_one_object_with_the_promised_names(tmp_path: Path) -> None:
    done = _run(
        "check", "lab_1_2.talker", "--json", "--", sys.executable, wrong_talker("wrong_text.py", tmp_path)
    )
    verdict = json.loads(done.stdout)
    assert verdict["exercise"] == "lab_1_2.talker"
    assert verdict["max_score"] == 10
    assert 0 < verdict["score"] < 10
    assert set(verdict["criteria"][0]) >= {"name", "passed", "expected", "seen"}
    assert verdict["diagnosis"]["key"] == "wrong_text"
    assert verdict["diagnosis"]["text"]


@pytest.mark.ros
def test_the_same_seed_gives_the_same_inputs() -> None:
    program = str(LISTENER / "right" / "text_as_it_stands.py")
    words = ("check", "lab_1_2.listener", "--json", "--seed", "s", "--", sys.executable, program)
    sent = [
        [m["label"] for m in json.loads(_run(*words).stdout)["timeline"] if m["direction"] == "to_subject"]
        for _ in range(2)
    ]
    # Which texts follow the first row depends on whether that was said at its pace, which a busy machine may prevent.
    row = 1 + AT_PACE
    assert len(set(sent[0][:row])) == row - 1, "one comes twice"
    assert sent[0][:row] == sent[1][:row]


@pytest.mark.ros
def test_a_judge_that_cannot_judge_ends_with_2_and_accuses_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Its reference output is missing.
    lab = tmp_path / "solutions" / "chapter" / "lab_1_2"
    lab.mkdir(parents=True)
    for file in TALKER.parent.glob("*.[pm][yd]"):
        shutil.copy(file, lab)
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    done = _run(
        "check", "lab_1_2.talker", "--", sys.executable, str(TALKER / "right" / "text_as_it_stands.py")
    )
    assert done.returncode == 2
    assert "COULD NOT BE CHECKED" in done.stdout
    assert "./course record lab_1_2.talker" in " ".join(done.stdout.split())


@pytest.mark.ros
def test_a_students_program_finds_the_modules_beside_it(tmp_path: Path) -> None:
    shutil.copy(TALKER / "right" / "text_as_it_stands.py", tmp_path / "my_talker.py")
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "of_mine.py").touch()
    (tmp_path / "run.py").write_text("import of_mine\nfrom my_talker import main\n\nmain()\n")
    command = (str(installed_program("autograder")), "check", "lab_1_2.talker", "--", "python3")
    environ = os.environ | {SAFE_PATH: "1", TYPED_PYTHONPATH: "tools"}  # as ./course sets them
    done = subprocess.run([*command, "run.py"], cwd=tmp_path, env=environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_printed_json_has_no_character_that_a_terminal_obeys(capsys: pytest.CaptureFixture[str]) -> None:
    said = "\x9b2J \u202eevil \U000e0041"
    show(not_checked("lab_1_2.talker", "Talker", 10, said), as_json=True)
    printed = capsys.readouterr().out.rstrip("\n")
    assert printed.isprintable()
    assert json.loads(printed)["diagnosis"]["text"] == said


PROFILE = """\
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
<participant profile_name="other" is_default_profile="true"><rtps>
<builtin><discovery_config><discoveryProtocol>CLIENT</discoveryProtocol></discovery_config></builtin>
<useBuiltinTransports>false</useBuiltinTransports>
</rtps></participant></profiles></dds>
"""


@pytest.mark.ros
def test_a_profile_of_the_middleware_in_the_current_folder_is_not_the_judges(tmp_path: Path) -> None:
    (tmp_path / "DEFAULT_FASTRTPS_PROFILES.xml").write_text(PROFILE)
    program = f"cd / && exec python3 '{TALKER / 'right' / 'usual.py'}'"
    command = (str(installed_program("autograder")), "check", "lab_1_2.talker", "--", "sh", "-c", program)
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
