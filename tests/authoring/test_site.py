"""The book: its links lead somewhere, it loads nothing from elsewhere, and its solutions are folded."""

from __future__ import annotations

import base64
import gzip
import html
import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from autograder import course, exercises
from autograder.authoring import site_building
from autograder.authoring.executed_masters import _run, show_as_a_students
from autograder.authoring.site_building import (
    MAX_PAGE_BYTES,
    SOLUTION_SUMMARY,
    book_page,
)
from autograder.masters.master_files import masters
from autograder.masters.source_notebooks import SET_UP_CELL as SET_UP_CELL
from autograder.masters.source_notebooks import service_links, source_notebook
from course_runtime.python_child import python_child
from tests.cases import cases

pytest.importorskip("sphinx_book_theme")
ROOT = Path(__file__).resolve().parents[2]
ELSEWHERE = re.compile(
    r"""<(?:script|img|iframe|source)\b[^>]*\bsrc=["'](?:https?:)?//|<link\b(?=[^>]*stylesheet|[^>]*preload)[^>]*href=["'](?:https?:)?//"""
)
LOADED = re.compile(r'(?:src|href)="([^"#?]+\.(?:js|css|png|gif|svg))\b')


@pytest.fixture(scope="module")
def book(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("book") / "pages"
    # In a process of its own: Sphinx keeps what one book has registered.
    command = python_child("-m", "autograder", "site", "--quick", "--to", str(folder))
    done = subprocess.run(command.command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_every_lab_has_a_page_and_every_page_is_small_and_loads_nothing(book: Path) -> None:
    pages = list(book.rglob("*.html"))
    names = {page.stem for page in pages}
    assert {master.parent.name for master in masters(ROOT)} | {
        "index",
        "mistakes",
        "glossary",
        "search",
    } <= names
    assert not [page.name for page in pages if page.stat().st_size > MAX_PAGE_BYTES]
    assert not [page.name for page in pages if ELSEWHERE.search(page.read_text(encoding="utf-8"))]


def test_title_and_footer_are_the_books(book: Path) -> None:
    page = (book / "chapters/01_ros2_fundamentals/lab_1_2.html").read_text(encoding="utf-8")
    (title,) = re.findall(r"<title>\s*(.*?)\s*</title>", page, re.DOTALL)
    name = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert html.unescape(title).endswith(f"— {name}")
    assert f"By {project['authors'][0]['name']}" in " ".join(page.split())
    assert f"License: {project['license']}" in page


def test_guides_stand_in_the_order_of_readers(tmp_path: Path) -> None:
    for name in ("README", "a", "b", "deep/c", "d"):
        page = tmp_path / f"{name}.md"
        page.parent.mkdir(exist_ok=True)
        page.write_text("", encoding="utf-8")
    guides = tmp_path / "README.md"
    guides.write_text(
        "[D](d.md), [C](deep/c.md#part), [gone](gone.md), [beside](../BESIDE.md)", encoding="utf-8"
    )
    assert site_building._pages_in_order(guides, ["../BESIDE", "../MORE"]) == [
        "d",
        "deep/c",
        "../BESIDE",
        "a",
        "b",
        "../MORE",
    ]


def test_a_page_with_all_that_it_loads_is_small_for_a_phone(book: Path) -> None:
    """As a web server sends it: the film of README is half of the largest page."""

    @cache
    def sent(file: Path) -> int:
        return len(gzip.compress(file.read_bytes()))

    sizes = {}
    for page in book.rglob("*.html"):
        files = {(page.parent / name).resolve() for name in LOADED.findall(page.read_text(encoding="utf-8"))}
        sizes[page.name] = sent(page) + sum(map(sent, files))
    assert max(sizes.values()) < MAX_PAGE_BYTES, sizes
    script = book / "_static/scripts/fontawesome.js"
    assert script.read_text(encoding="utf-8") == ""


def test_each_icon_of_a_page_is_a_character_of_the_style_sheet(book: Path) -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in book.rglob("*.html"))
    classes = " ".join(re.findall(r'<(?:i|span) class="([^"]*\bfa-solid [^"]*)"', text)).split()
    shown = {name for name in classes if name.startswith("fa-")}
    drawn = set(re.findall(r"\.(fa-[\w-]+)::before", (book / "_static/book.css").read_text(encoding="utf-8")))
    assert shown - drawn == {"fa-lg", "fa-fw"}


def test_a_table_that_is_wider_than_a_phone_is_moved_by_the_keyboard(book: Path) -> None:
    tables = re.findall(r'<table class="table"[^>]*>', (book / "docs/learning-outcomes.html").read_text())
    assert set(tables) == {'<table class="table" tabindex="0">'}


def test_fairness_tells_task_by_task_what_the_cards_say(book: Path) -> None:
    text = re.sub(r"<[^>]*>", "", (book / "docs/fairness.html").read_text(encoding="utf-8"))
    talker = exercises.get("lab_1_2.talker")
    assert f"{talker.title}#" in text
    assert f"Keeps the rate: {talker.counts['rate']}" in text
    assert "Not graded: “log the string that it publishes”." in text


def test_solutions_are_folded(book: Path) -> None:
    page = (book / "chapters/01_ros2_fundamentals/lab_1_2.html").read_text(encoding="utf-8")
    text = re.sub(r"<[^>]*>", "", page)
    assert "Learning Outcomes" in text
    assert "Set the course up, outside of" not in text
    assert SOLUTION_SUMMARY in text
    assert "create_timer(0.5, self.say_hello)" in text
    assert "TODO: make the publisher and the timer" in text


def test_a_page_of_a_public_course_opens_its_notebook_in_a_browser(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(course, "repository", lambda _: "https://github.com/ada/ros")
    for master in masters(ROOT):
        text = str(book_page(source_notebook(master), with_solutions=True))
        notebook = f"chapters/{master.parents[1].name}/{master.parent.name}.ipynb"
        for link in service_links("https://github.com/ada/ros", notebook).values():
            assert f"]({link})" in text


def test_a_line_that_was_printed_in_two_pieces_is_one_line_without_the_folder_of_the_run() -> None:
    pieces = ("in /run/course-si", "te-1/notebooks/ros2_ws")
    cell = new_code_cell(outputs=[new_output("stream", text=piece) for piece in pieces])
    show_as_a_students(new_notebook(cells=[cell]), "/run/course-site-1/notebooks")
    assert [output.text for output in cell.outputs] == ["in /home/you/course/ros2_ws"]


SHOW = cases(__file__, "SHOW")
MEANWHILE = """\
thread = threading.Thread(target=cell.run, args=(move,))
thread.start()
thread.join()"""
LATER = """\
def slowly():
    for x in range(1, 6):
        time.sleep(0.4)
        handle.update(picture(x))

import time
threading.Thread(target=cell.run, args=(slowly,)).start()"""


@pytest.mark.slow
def test_a_picture_that_moves_while_a_later_cell_runs_is_shown_as_it_was_at_the_end() -> None:
    """So the robot does: one cell shows it, and the next ones drive it."""
    done = _run(new_notebook(cells=[new_code_cell(SHOW), new_code_cell(MEANWHILE)]), ROOT)
    (shown,) = done.cells[0].outputs
    drawn = base64.b64decode(shown.data["text/html"].partition("base64,")[2].partition('"')[0])
    assert b'cx="5"' in drawn


@pytest.mark.slow
def test_a_picture_that_goes_on_moving_is_shown_at_rest() -> None:
    """So the robot does whose driver works in the background: the next cell begins before the robot has arrived."""
    done = _run(new_notebook(cells=[new_code_cell(f"{SHOW}\n{LATER}")]), ROOT)
    (shown,) = done.cells[0].outputs
    drawn = base64.b64decode(shown.data["text/html"].partition("base64,")[2].partition('"')[0])
    assert b'cx="5"' in drawn
