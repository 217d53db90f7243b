"""``./course replay`` and ``./course check --mcap``: what they print, and with which exit code they end."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from mcap.reader import make_reader

from autograder.authoring.answer_bank import answers_folder
from autograder.cli import cli
from autograder.notebook.observing.message_recordings import read_recording

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def run(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(cli, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.output


FORGED = "ada\x1b[2J\nthe same verdict, points and diagnosis, forged\u202e"


def edit(file: Path, change: Callable[[dict[str, Any]], object]) -> None:
    content = json.loads(file.read_text(encoding="utf-8"))
    change(content)
    file.write_text(json.dumps(content), encoding="utf-8")


def test_the_same_verdict_ends_with_0(file: Path) -> None:
    code, said = run("replay", file)
    assert code == 0
    assert said.splitlines() == [
        "lab_1_2.talker by ada, checked 2027-01-15 08:00:00 UTC with course 01234567",
        "then: passed, 10 of 10 points",
        "now:  passed, 10 of 10 points",
        "the same verdict, points and diagnosis",
        "note: any person can write such a file; for proof, have `./course appeal` write it from the class",
    ]


def test_a_replay_as_json_has_both_verdicts(file: Path) -> None:
    code, said = run("replay", file, "--json")
    replay = json.loads(said)["replay"]
    assert (code, replay["differences"]) == (0, [])
    assert replay["then"]["score"] == replay["now"]["score"] == 10


def test_an_edited_verdict_is_not_the_one_that_follows(file: Path) -> None:
    edit(file, lambda content: content["seen"]["verdict"].update(score=3.0, state="failed"))
    code, said = run("replay", file)
    assert code == 1
    assert "state: was failed, is passed" in said
    assert "points: was 3 of 10, is 10 of 10" in said
    assert "any person can write such a file" in said


def test_edited_evidence_is_judged_as_what_it_says(file: Path) -> None:
    text = file.read_text(encoding="utf-8").replace('"Hello, world! 3"', '"Hello, world! 7"')
    file.write_text(text, encoding="utf-8")
    code, said = run("replay", file)
    assert code == 1
    assert "now:  failed" in said
    assert "diagnosis: was none, is" in said


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.update(student=FORGED),
        lambda content: content.update(course=FORGED),
        lambda content: content["seen"]["verdict"].update(exercise=FORGED),
        lambda content: content["seen"]["verdict"]["criteria"][0].update(name=FORGED),
        lambda content: content["seen"].update(cut=FORGED),
    ],
)
def test_a_forged_name_neither_begins_a_line_nor_reaches_the_terminal(
    file: Path, change: Callable[[dict[str, Any]], object]
) -> None:
    edit(file, change)
    _, said = run("replay", file)
    assert "\x1b" not in said
    assert not any(
        line.startswith("the same verdict, points") and "forged" in line for line in said.splitlines()
    )
    assert "\u202e" not in said


def test_what_is_printed_of_an_honest_file_with_a_forged_name_is_escaped(file: Path) -> None:
    edit(file, lambda content: content.update(student=FORGED))
    assert "ada\\x1b[2J\\nthe same verdict, points and diagnosis, forged\\u202e" in run("replay", file)[1]


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.update(student="ada" * 1_000_000),
        lambda content: content["seen"].update(cut="cut" * 1_000_000),
        lambda content: content["seen"]["verdict"]["criteria"].extend(
            {**content["seen"]["verdict"]["criteria"][0], "name": f"criterion {number}"}
            for number in range(10_000)
        ),
    ],
)
def test_a_forged_file_does_not_flood_the_terminal(
    file: Path, change: Callable[[dict[str, Any]], object]
) -> None:
    edit(file, change)
    _, said = run("replay", file)
    assert len(said) < 10_000


def test_another_reference_output_is_told(file: Path) -> None:
    edit(file, lambda content: content["seen"].update(reference="of long ago"))
    assert "the reference output of this exercise has changed since" in run("replay", file)[1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda c: c["seen"].update(cut="the last 9 lines are missing"),
            "no verdict follows from it",
        ),
        (lambda c: c["seen"].update(looks=[]), "the judge saw nothing in this check"),
        (lambda c: c["seen"]["verdict"].update(exercise="lab_1_2.talkr"), "did you mean lab_1_2.talker"),
        (
            lambda c: [e.update(data={}) for p in c["seen"]["looks"][0]["parts"] for e in p["events"]],
            "cannot be decided from this evidence",
        ),
    ],
)
def test_what_cannot_be_judged_again_ends_with_2(
    file: Path, change: Callable[[dict[str, Any]], object], words: str
) -> None:
    edit(file, change)
    code, said = run("replay", file)
    assert code == 2
    assert words in said
    assert "Traceback" not in said


def first_event(content: dict[str, Any]) -> dict[str, Any]:
    event: dict[str, Any] = content["seen"]["looks"][0]["parts"][0]["events"][0]
    return event


@pytest.mark.parametrize("options", [[], ["--mcap"], ["--bag"]])
@pytest.mark.parametrize(
    "change",
    [
        lambda content: content["seen"].update(at=float("nan")),
        lambda content: content["seen"].update(at=1e308),
        lambda content: content["seen"].update(at=-(10**18)),
        lambda content: content["expected"].update(x={"$float": 10**400}),
    ],
)
def test_a_number_that_none_can_be_ends_with_2(
    file: Path, tmp_path: Path, change: Callable[[dict[str, Any]], object], options: list[str]
) -> None:
    edit(file, change)
    code, said = run("replay", file, *options, *(tmp_path / "check.mcap" for _ in options))
    assert code == 2
    assert "is not a valid appeal file" in said


@pytest.mark.parametrize("option", ["--mcap", "--bag"])
@pytest.mark.parametrize(
    "change",
    [
        lambda content: first_event(content)["data"].update(publisher=None),
        lambda content: first_event(content)["data"].update(fields=3),
        lambda content: first_event(content).update(t=float("inf")),
    ],
)
def test_messages_that_none_can_be_end_with_2(
    file: Path, tmp_path: Path, change: Callable[[dict[str, Any]], object], option: str
) -> None:
    edit(file, change)
    code, said = run("replay", file, option, tmp_path / "check.mcap")
    assert code == 2
    assert "is not a valid appeal file" in said


def test_a_file_that_is_none_ends_with_2(tmp_path: Path) -> None:
    code, said = run("replay", tmp_path / "none.json")
    assert code == 2
    assert said.startswith("autograder: ")


def test_messages_are_written_as_mcap(file: Path, tmp_path: Path) -> None:
    code, said = run("replay", file, "--mcap", tmp_path / "check.mcap")
    assert code == 0
    with (tmp_path / "check.mcap").open("rb") as stream:
        reader = make_reader(stream)
        texts = [json.loads(m.data)["data"] for _, _, m in reader.iter_messages(topics=["/chatter"])]
        (about,) = [one.metadata for one in reader.iter_metadata()]
    assert texts[:2] == ["Hello, world! 0", "Hello, world! 1"]
    assert (about["exercise"], about["state"], about["score"]) == ("lab_1_2.talker", "passed", "10")
    assert f"{len(texts) + 1} events" in said


def test_the_messages_of_topics_are_written_for_ros2_bag(file: Path, tmp_path: Path) -> None:
    code, said = run("replay", file, "--bag", tmp_path / "bag.mcap")
    assert code == 0
    texts = [one.message.data for one in read_recording(tmp_path / "bag.mcap", ["/chatter"])]
    assert texts[:2] == ["Hello, world! 0", "Hello, world! 1"]
    assert f"{len(texts)} messages of topics" in said


def test_a_type_in_a_forged_file_imports_no_module(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "forged_msgs").mkdir()
    (tmp_path / "forged_msgs" / "__init__.py").touch()
    (tmp_path / "forged_msgs" / "msg.py").write_text("class String: pass\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    edit(file, lambda c: first_event(c)["data"].update(publisher={"/chatter": "forged_msgs/msg/String"}))
    assert "their type is not installed here" in run("replay", file, "--bag", tmp_path / "bag.mcap")[1]
    assert "forged_msgs" not in sys.modules


@pytest.mark.parametrize("option", ["--mcap", "--bag"])
@pytest.mark.parametrize(
    ("name", "words"), [("check.bag", "such as check.mcap"), ("none/check.mcap", "cannot be written")]
)
def test_a_place_for_messages_that_is_none_ends_with_2(
    file: Path, tmp_path: Path, name: str, words: str, option: str
) -> None:
    code, said = run("replay", file, option, tmp_path / name)
    assert code == 2
    assert words in said


@pytest.mark.ros
def test_the_messages_of_a_check_in_a_terminal(tmp_path: Path) -> None:
    program = answers_folder("lab_1_2.talker") / "right" / "text_as_it_stands.py"
    path = tmp_path / "check.mcap"
    code, said = run("check", "lab_1_2.talker", "--mcap", path, "--", sys.executable, program)
    assert code == 0, said
    with path.open("rb") as stream:
        found = list(make_reader(stream).iter_messages(topics=["/chatter"]))
    schemas = {(schema.name, schema.encoding) for schema, _, _ in found if schema}
    assert schemas == {("std_msgs/msg/String", "jsonschema")}
    # A program publishes from its start on, so the judge may miss its first messages.
    first, second = (int(json.loads(m.data)["data"].removeprefix("Hello, world! ")) for _, _, m in found[:2])
    assert second == first + 1


def test_another_ending_is_said_before_anything_is_run(tmp_path: Path) -> None:
    code, said = run(
        "check", "lab_1_2.talker", "--mcap", tmp_path / "a.bag", "--", "touch", tmp_path / "it_ran"
    )
    assert code == 2
    assert "such as check.mcap" in said
    assert not (tmp_path / "it_ran").exists()
