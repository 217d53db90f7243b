"""The course page and its words for a terminal."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from click.testing import CliRunner

from autograder import check_journal, course, exercises
from autograder.cards.certificate import WORDS, Certificate
from autograder.check_journal import JournalEntry
from autograder.cli import cli
from autograder.student.progress import hours, page_html, standing, standing_text, trouble_html

if TYPE_CHECKING:
    from pathlib import Path

ROOT = course.root()
TALKER = JournalEntry("check", "lab_1_2.talker", 1, 10, 10)


def page(*entries: JournalEntry) -> str:
    return page_html(standing(ROOT, ROOT / course.CHAPTERS, entries), "/user/ann/", "token")


def test_it_fetches_nothing_from_elsewhere_and_leads_below_the_servers_address() -> None:
    html = page(TALKER)
    assert not re.findall(r'(?:src|href|url)\s*[=(]\s*"?(?:https?:)?//', html)
    assert 'href="/user/ann/lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"' in html


def test_what_a_chapter_is_called_is_text() -> None:
    found = standing(ROOT, ROOT / course.CHAPTERS, ())
    named = replace(found.chapters[0], title="<script>alert(1)</script>", finished=1.0)
    html = page_html(replace(found, chapters=(named,)), "/", "token")
    assert "<script>alert" not in html
    assert "&lt;script&gt;alert" in html


def test_a_course_that_cannot_be_read_still_has_a_way_to_the_notebooks() -> None:
    html = trouble_html("chapter.toml: <what> is that?", "/user/ann/")
    assert "&lt;what&gt; is that?" in html
    assert 'href="/user/ann/lab"' in html


def test_a_certificate_comes_with_the_last_point_and_says_what_it_is_worth() -> None:
    everything = [JournalEntry("check", exercise, 86_400, 10, 10) for exercise in exercises.all_ids()]
    assert WORDS not in page(*everything[1:]).partition("</h2>")[2].partition("</section>")[0]
    assert WORDS in page(*everything)
    svg = Certificate("Nodes & <Topics>", 130, 86_400).svg()
    assert "Nodes &amp; &lt;Topics&gt;" in svg
    assert ("All 130 points" in svg, "1970" in svg, "not a grade" in svg) == (True, True, True)


def test_a_task_with_the_worked_solution_says_so_on_the_page_and_on_the_certificate() -> None:
    words = "1 task with the worked solution"
    opened = JournalEntry("solution", TALKER.name, 0)
    everything = [JournalEntry("check", exercise, 86_400, 10, 10) for exercise in exercises.all_ids()]
    row = page(opened, TALKER).partition('data-notebook="lab_1_2"')[2].partition("</li>")[0]
    assert words in row
    assert words not in page(TALKER, opened)
    certificate = page(opened, *everything).partition("<figure")[2].partition("</figure>")[0]
    assert certificate.count(words) == 3, "in the picture, its label, and the words below it"
    assert words in standing_text(standing(ROOT, ROOT / course.CHAPTERS, (opened, TALKER)))


def test_the_terminal_says_the_same(tmp_path: Path) -> None:
    check_journal.note(TALKER, tmp_path / check_journal.NAME)
    said = CliRunner().invoke(cli, ["progress", "--folder", str(tmp_path)])
    assert said.exit_code == 0
    assert re.search(r"\[~\] Lab 1\.2: A talker and a listener +75 min +10 of 50 points", said.output)
    assert "Go on with Lab 1.2: A talker and a listener" in said.output


def test_nobody_is_told_minutes_that_nobody_has_measured() -> None:
    assert [hours(minutes) for minutes in (40, 60, 95, 455)] == [
        "40 minutes",
        "1 hour",
        "1½ hours",
        "7½ hours",
    ]
