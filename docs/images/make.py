"""Take the pictures of the documentation: ``.venv/bin/python -m docs.images.make``.

Cards and course page are what the browser tests see in a real JupyterLab, the page about a class and the head of a
feedback page are those of the sample class, graded again: a picture shows what the course does today. With the words
``lab``, ``class`` or ``film`` it takes only these; the moving picture of the README (``film.py``) needs Pillow.

The words that a picture shows are kept beside it, in ``words.json``: ``tests/test_pictures.py`` fails if the course
says something else now.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from autograder.grading.new_classes.sample_class import DATA, sample_data
from autograder.safe_files import HeldFolder
from course_runtime.python_child import python_child
from course_runtime.system_packages import CHROMIUM_NAMES, find_program

HERE = Path(__file__).resolve().parent
TESTS = ("tests/browser/test_lab_1_2.py", "tests/browser/test_course_page.py")
TAKEN = ("passed.png", "course-panel.png")
LARGEST = 300_000
"""Bytes of a picture: a clone should not grow with every new look of a card."""
LARGEST_FILM = 1_200_000
"""Bytes of the moving picture."""


SEEN = 1500
"""Pixels of the page about the class, from its top."""
WORDS = HERE / "words.json"


def main() -> int:
    """Take the pictures, all or only some; the exit code."""
    with HeldFolder("autograder-pictures-") as held:
        folder = held.path
        wanted = sys.argv[1:] or ["lab", "class", "film"]
        taken: tuple[str, ...] = ()
        if "lab" in wanted:
            see_the_lab(folder)
            taken += TAKEN
        if "class" in wanted:
            taken += see_a_class(folder)
        if "film" in wanted:
            from docs.images.film import record  # needs Pillow, as nothing else does

            taken += (record(folder),)
        missing = [name for name in taken if not (folder / name).exists()]
        if missing:
            print(f"no pictures: the browser tests must pass first {missing}", file=sys.stderr)
            return 1
        for name in taken:
            picture = folder / name
            largest = LARGEST_FILM if picture.suffix == ".gif" else LARGEST
            if picture.stat().st_size > largest:
                print(f"{name} is larger than {largest} bytes: make the window smaller", file=sys.stderr)
                return 1
            shutil.copy(picture, HERE / name)
        words = json.loads(WORDS.read_text(encoding="utf-8")) if WORDS.is_file() else {}
        for name in taken:
            words[name] = " ".join((folder / name).with_suffix(".txt").read_text(encoding="utf-8").split())
        WORDS.write_text(
            json.dumps(words, indent=2, ensure_ascii=False, sort_keys=True) + "\n", encoding="utf-8"
        )
    return 0


def see_the_lab(folder: Path) -> None:
    """Run the browser tests with a folder for their pictures."""
    test = python_child("-m", "pytest", "-q", *TESTS).command
    subprocess.run(test, cwd=HERE.parents[1], env=os.environ | {"SCREENSHOTS": str(folder)}, check=True)


def see_a_class(folder: Path) -> tuple[str, ...]:
    """Grade the sample class and look at its pages; the pictures' names."""
    made = folder / "demo-class"
    subprocess.run([*python_child("-m", "autograder").command, "demo", str(made)], check=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=find_program(*CHROMIUM_NAMES), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 1000, "height": 800})
        page.goto((made / "report.html").as_uri())
        page.screenshot(
            path=folder / "class-report.png",
            clip={"x": 0, "y": 0, "width": 1000, "height": SEEN},
            full_page=True,
        )
        (folder / "class-report.txt").write_text(page.locator("body").inner_text(), encoding="utf-8")
        student, assignment = sample_data(DATA).shown
        page.goto((made / "feedback" / student / assignment / f"{assignment}.html").as_uri())
        head = page.locator(".panel-heading").first
        head.screenshot(path=folder / "feedback-head.png")
        (folder / "feedback-head.txt").write_text(head.inner_text(), encoding="utf-8")
        browser.close()
    return "class-report.png", "feedback-head.png"


if __name__ == "__main__":
    sys.exit(main())
