"""Each picture of the documentation shows what the course says today, by the words that were recorded with it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from autograder import course, exercises
from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import answers
from autograder.cards import card_wording
from autograder.grading.new_classes.sample_class import DATA, sample_data
from tests.measure.evidence import kept, record_of

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
AGAIN = "take it again: .venv/bin/python -m docs.images.make"
WORDS: dict[str, str] = json.loads((IMAGES / "words.json").read_text(encoding="utf-8"))
TALKER = "lab_1_2.talker"


def missing(picture: str, *said: str) -> list[str]:
    """Which of these words a picture does not show, whatever stands between lines."""
    shown = "".join(WORDS[picture].split()).casefold()
    return [one for one in said if "".join(one.replace("`", "").split()).casefold() not in shown]


def test_each_picture_has_its_words() -> None:
    pictures = {file.name for kind in ("png", "gif") for file in IMAGES.glob(f"*.{kind}")}
    assert set(WORDS) == pictures, AGAIN


@pytest.mark.parametrize("picture", ["passed.png", "lab.gif"])
def test_a_card_has_the_criteria_of_today(picture: str) -> None:
    assert not missing(picture, *(one.title for one in exercises.get(TALKER).criteria)), AGAIN


def test_the_films_card_says_what_the_card_says_today() -> None:
    answer = next(one for one in answers([TALKER]) if one.name.endswith("wrong/topic_name.py"))
    advice = card_wording.advice(replay(record_of(answer, kept(TALKER).get(answer.name)).seen).now)
    told, _, _ = advice.text.partition(" Line ")
    assert not missing("lab.gif", told, advice.next_step), AGAIN


def test_the_course_page_has_the_points_of_today() -> None:
    chapter = course.chapters(ROOT)[0]
    names = [name for lab in chapter.labs for name in chapter.exercises_of(lab)]
    points = sum(exercises.get(name).points for name in names)
    assert not missing("course-panel.png", f"10 of {points:g} points"), AGAIN


def test_the_course_page_has_the_titles_and_minutes_of_today() -> None:
    # The picture shows the first chapter; the second one is below its edge.
    for lab in course.chapters(ROOT)[0].labs:
        text = (lab / "lab.md").read_text(encoding="utf-8")
        title, minutes = re.search(r"(?m)^# (.+)$", text), re.search(r"(?m)^\*(\d+) minutes ", text)
        assert title
        assert minutes
        state = "begun" if lab.name == "lab_1_2" else "not begun"
        assert not missing("course-panel.png", f"{title[1]} , {state} {minutes[1]} min"), AGAIN


def test_the_page_about_a_class_has_the_headings_of_today() -> None:
    page = (ROOT / "autograder/grading/reporting/report.html.j2").read_text(encoding="utf-8")
    headings = set(re.findall(r"<h2>(.*?)</h2>", page))
    assert len(headings) > 3
    assert not missing("class-report.png", *headings), AGAIN


def test_the_head_of_a_feedback_page_has_the_titles_of_today() -> None:
    _, name = sample_data(DATA).shown
    lab = ROOT / "solutions/01_ros2_fundamentals" / name
    title = re.search(r"^# (.+)$", (lab / "lab.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert title
    titles = (one.title for one in exercises.unbroken() if one.id.startswith(f"{name}."))
    assert not missing("feedback-head.png", title[1], *titles), AGAIN
