"""The first minutes: from the opened notebook to a robot that moves and a green card."""

from __future__ import annotations

import base64
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look, until

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
ROBOT = 'img[alt^="The robot is in"]'


@pytest.fixture(autouse=True)
def nobody_drives(page: Page, lab: str) -> None:
    """Ends the kernels of earlier tests: what they have left spinning would drive this test's robot, too."""
    for kernel in page.request.get(lab.format("api/kernels")).json():
        assert page.request.delete(lab.format(f"api/kernels/{kernel['id']}")).ok


def test_a_student_drives_the_robot_in_five_actions(page: Page, lab: str) -> None:
    """Open, run the first cell, write two lines, see the robot go through the door, and the card is green."""
    from playwright.sync_api import expect

    page.goto(lab.format("lab/tree/01_ros2_fundamentals/00_nervous_system.ipynb"))
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")

    first = notebook.run(r"^from geometry_msgs")
    standing = first.locator(ROBOT)
    expect(standing).to_have_attribute("alt", re.compile(r"x = 1\.00 m, .*It stands still\."))
    look(page, "robot-stands")

    task = notebook.cell(r"^class Driver")
    expect(task.locator(".cm-content")).to_contain_text("# TODO")
    expect(task.locator(".jp-InputArea-editor")).to_have_css("border-left-width", "4px")
    editor = first.locator(".jp-InputArea-editor")
    expect(editor).to_have_css("border-left-width", "1px")
    first.locator(".cm-content").click()
    after = "one => getComputedStyle(one, '::after').content"
    until(page, lambda: "cannot be changed" in editor.evaluate(after))
    notebook.write(r"^class Driver", driver())
    notebook.run(r"^class Driver")
    driven = notebook.run(r"^driving = ").locator(ROBOT)
    look(page, "robot-moves")
    expect(driven).to_have_attribute("alt", re.compile(r"in the right room.*A wall is in its way"))

    checked = notebook.run(r'^check\("00_nervous_system')
    expect(checked.locator(".agc-passed")).to_contain_text("10 of 10 points")
    look(page, "first-green")
    until(page, lambda: "trail" in picture_of(driven))


def test_the_arrow_keys_drive_the_robot(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    page.goto(lab.format("lab/tree/01_ros2_fundamentals/00_nervous_system.ipynb"))
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    first = notebook.run(r"^from geometry_msgs")
    robot, button = first.locator(ROBOT), first.get_by_role("button", name="Drive with the arrow keys")
    expect(robot).to_have_attribute("alt", re.compile(r"x = 1\.00 m"))
    button.click()
    expect(page.locator("body")).to_have_class(re.compile("ros2-course-drives"))
    page.keyboard.down("ArrowUp")
    expect(robot).to_have_attribute("alt", re.compile(r"in the right room"), timeout=60_000)
    look(page, "robot-driven-by-keys")
    page.keyboard.up("ArrowUp")
    expect(robot).to_have_attribute("alt", re.compile(r"It stands still\."))
    page.keyboard.press("Escape")
    expect(page.locator("body")).not_to_have_class(re.compile("ros2-course-drives"))


def picture_of(robot: Locator) -> str:
    """The SVG of the robot's picture, as it is now."""
    return base64.b64decode((robot.get_attribute("src") or "").partition("base64,")[2]).decode()


def driver() -> str:
    """What a student has in the solution cell in the end."""
    master = Path(__file__).parents[2] / "solutions/01_ros2_fundamentals/00_nervous_system/lab.md"
    cell = master.read_text(encoding="utf-8").partition("class Driver(Node):")[2].partition("```")[0]
    kept = [line for line in cell.splitlines() if "###" not in line and "# TODO" not in line]
    return "class Driver(Node):" + "\n".join(kept)
