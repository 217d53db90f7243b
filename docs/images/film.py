"""Record the moving picture of the README in a real JupyterLab: ``.venv/bin/python -m docs.images.make film``.

Pillow writes the file: type ``.venv/bin/python -m pip install pillow`` first. A film is a list of shots, each with its
time. Waiting is cut out; a caption below each shot says what happens.
"""

from __future__ import annotations

import io
import os
import re  # noqa: TID251  (the texts are the course's own)
import shutil
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image
from playwright.sync_api import expect, sync_playwright

from course_runtime.system_packages import CHROMIUM_NAMES, find_program
from tests.browser.open_notebook import OpenNotebook
from tests.browser.server_of_a_test import jupyter_server

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 830, 400
"""Pixels of the picture: GitHub shows a README about this wide, so that text is as sharp as in JupyterLab."""
TOP, SIDE = 90, 40
"""Pixels of JupyterLab's own menus and tabs above the picture, and of its margins beside it."""
SECONDS = 180
"""Seconds after which recording gives up waiting for something that a quiet machine shows within ten."""
ROBOT = 'img[alt^="The robot is in"]'
ALONE = """
#jp-left-stack, .jp-SideBar, #jp-main-statusbar, .jp-cell-toolbar { display: none !important }
#film { position: fixed; z-index: 9999; left: 0; right: 0; bottom: 0; padding: 7px 54px; height: 20px;
        background: #1a2b4c; color: white; font: 600 16px sans-serif }
.jp-WindowedPanel-outer { padding-bottom: 40px }
"""

DRIVE = ["        command.linear.x = 0.5", "        self.publisher.publish(command)"]
TALKER = '''class TalkerNode(Node):
    """Says "Hello, world! N" on the topic chatter every 0.5 s."""

    def __init__(self) -> None:
        super().__init__("talker_node")
        self.count = 0
        self.publisher = self.create_publisher(String, "TOPIC", 10)
        self.create_timer(0.5, self.say_hello)

    def say_hello(self) -> None:
        self.publisher.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1'''


@dataclass
class Film:
    """The shots of one page, and the milliseconds that each is shown; and the words of its cards."""

    page: Page
    words: list[str] = field(default_factory=list)
    shots: list[tuple[Image.Image, int]] = field(default_factory=list)

    def say(self, words: str) -> None:
        """Show this caption from now on."""
        self.page.evaluate(
            """words => { let bar = document.getElementById("film");
            if (!bar) { bar = document.createElement("div"); bar.id = "film"; document.body.append(bar); }
            bar.textContent = words; }""",
            words,
        )

    def shoot(self, milliseconds: int) -> None:
        """Keep what is seen now."""
        seen = self.page.screenshot(
            clip={"x": SIDE, "y": TOP, "width": WIDTH, "height": HEIGHT}, animations="disabled", caret="hide"
        )
        self.shots.append((Image.open(io.BytesIO(seen)).convert("RGB"), milliseconds))

    def type(self, text: str, at_once: int = 4) -> None:
        """Type a text, and show a few letters more in each shot."""
        for start in range(0, len(text), at_once):
            self.page.keyboard.insert_text(text[start : start + at_once])
            self.shoot(90)

    def save(self, path: Path) -> None:
        """Write an animated GIF with one palette, so that each frame holds only what has changed."""
        sample = Image.new("RGB", (WIDTH, HEIGHT * len(self.shots)))
        for place, (shot, _) in enumerate(self.shots):
            sample.paste(shot, (0, HEIGHT * place))
        palette = sample.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
        frames = [shot.quantize(palette=palette, dither=Image.Dither.NONE) for shot, _ in self.shots]
        times = [milliseconds for _, milliseconds in self.shots]
        frames[0].save(path, save_all=True, append_images=frames[1:], duration=times, loop=0, optimize=False)


def record(folder: Path) -> str:
    """Record the film into a folder; the name of its file."""
    chapters = Path(shutil.copytree(ROOT / "chapters", folder / "student" / "chapters"))
    (chapters / ".course-journal.jsonl").unlink(missing_ok=True)
    environ = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}
    expect.set_options(timeout=SECONDS * 1000)
    arguments = ["autograder", "lab", "--folder", str(chapters)]
    with jupyter_server(arguments, "student", folder, environ) as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=find_program(*CHROMIUM_NAMES), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": WIDTH + 2 * SIDE, "height": TOP + HEIGHT})
        page.set_default_timeout(SECONDS * 1000)
        film = Film(page)
        drive_the_robot(film, opened(page, address, "00_nervous_system"))
        correct_the_talker(film, opened(page, address, "lab_1_2"))
        browser.close()
    film.save(folder / "lab.gif")
    (folder / "lab.txt").write_text("\n".join(film.words), encoding="utf-8")
    return "lab.gif"


def opened(page: Page, address: str, name: str) -> OpenNotebook:
    """Open a notebook, without the panels beside it."""
    page.goto(f"{address}lab/tree/01_ros2_fundamentals/{name}.ipynb?token=student&reset")
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    if page.locator("#jp-left-stack").is_visible():
        page.keyboard.press("Control+b")
    page.add_style_tag(content=ALONE)
    return notebook


def at_the_top(found: Locator) -> None:
    """Scroll until this is at the top of the picture."""
    found.evaluate("one => one.scrollIntoView({block: 'start'})")
    found.page.wait_for_timeout(400)


def drive_the_robot(film: Film, notebook: OpenNotebook) -> None:
    """Write the two lines of the first notebook, and see the robot go through the door."""
    expect(notebook.run(r"^from geometry_msgs").locator(ROBOT)).to_have_attribute("alt", re.compile("still"))
    task = notebook.cell(r"^class Driver")
    task.locator(".cm-line", has_text="# TODO").click()
    at_the_top(task)
    film.say("1. Write two lines of ROS 2 …")
    film.page.keyboard.press("End")
    film.page.keyboard.press("Shift+Home")
    film.page.keyboard.press("Shift+Home")
    film.page.keyboard.press("Delete")
    film.shoot(700)
    film.type(DRIVE[0])
    film.type("\n" + DRIVE[1])
    film.shoot(500)
    notebook.run(r"^class Driver")
    driven = notebook.run(r"^driving = ")
    expect(driven.locator(ROBOT)).to_be_visible()
    at_the_top(driven)
    film.say("… and your robot drives.")
    until = time.monotonic() + SECONDS
    while time.monotonic() < until:
        film.shoot(200)
        if "A wall is in its way" in (driven.locator(ROBOT).get_attribute("alt") or ""):
            break
        film.page.wait_for_timeout(350)
    film.shoot(900)


def correct_the_talker(film: Film, notebook: OpenNotebook) -> None:
    """Mistype a topic, read the card, correct the name, and see the green card."""
    expect(notebook.run(r"^import time")).to_contain_text(re.compile("ROS 2 is up"))
    before, _, after = TALKER.partition("TOPIC")
    notebook.write(r"^class TalkerNode", before + after)
    task = notebook.cell(r"^class TalkerNode")
    topic = task.locator(".cm-line", has_text="create_publisher")
    for _step in range(2):
        at_the_top(task)
    film.say("2. A slip: the topic is called chatter.")
    topic.click()
    film.page.keyboard.press("End")
    for _letter in range(len('", 10)')):
        film.page.keyboard.press("ArrowLeft")
    film.shoot(600)
    film.type("chater", 1)
    film.shoot(1200)
    notebook.run(r"^class TalkerNode")
    checked = notebook.run(r'^check\("lab_1_2\.talker"')
    expect(checked.locator(".agc-failed")).to_contain_text("chater")
    film.words.append(checked.locator(".agc-failed").inner_text())
    at_the_top(checked)
    film.say("3. The judge heard it on the wire, and says what to do.")
    film.shoot(4000)
    topic.click()
    at_the_top(task)
    film.page.keyboard.press("End")
    for _letter in range(len('er", 10)')):
        film.page.keyboard.press("ArrowLeft")
    film.say("4. Mend it …")
    film.shoot(600)
    film.type("t", 1)
    film.shoot(700)
    notebook.run(r"^class TalkerNode")
    passed = task.locator(".agc-passed")
    expect(passed).to_contain_text("10 of 10 points")
    film.words.append(passed.inner_text())
    passed.evaluate("one => one.scrollIntoView({block: 'end'})")
    film.page.wait_for_timeout(400)
    film.say("… and it is checked again as soon as the cell has run.")
    film.shoot(4000)
