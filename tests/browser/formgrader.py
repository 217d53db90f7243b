"""nbgrader's formgrader in a browser, used as by hand."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from playwright.sync_api import expect

if TYPE_CHECKING:
    from collections.abc import Callable

    from playwright.sync_api import Locator, Page, Response

ELSEWHERE = re.compile(r"^https?://(?!127\.0\.0\.1[:/])")


class Formgrader:
    """Formgrader in the folder of a class, on a machine without a network: its formulas stay as TeX.

    Args:
        page: An empty page.
        address: The Jupyter server's, which ends with a slash.
        token: Lets a browser in.
    """

    def __init__(self, page: Page, address: str, token: str) -> None:
        self.page = page
        self._address = address
        page.route(ELSEWHERE, lambda route: route.abort())
        # Jupyter's own pages let a browser in for good, formgrader's only once.
        page.goto(f"{address}tree?token={token}", wait_until="commit")

    def open(self, place: str) -> None:
        """Open one of its pages."""
        self.page.goto(f"{self._address}formgrader/{place}")

    def autograde(self, assignment: str, student: str) -> Locator:
        """Press a student's button in the list of submissions, and give back the student's line when it is done."""
        self.open(f"manage_submissions/{assignment}")
        line = self.page.locator("#main-table tr").filter(
            has=self.page.locator(f".student-id[data-order='{student}']")
        )
        expect(line).to_contain_text("needs autograding")
        line.locator(".autograde a").click()
        said = self.page.locator(".modal-dialog")
        expect(said).to_contain_text("Successfully autograded")
        said.get_by_role("button", name="OK").click()
        expect(line).not_to_contain_text("Please wait")
        return line

    def first_submission(self, assignment: str) -> None:
        """Go by its links to the first submission of an assignment of one notebook."""
        self.open("gradebook")
        for link in (assignment, assignment, "Submission #1"):
            self._follow(self.page.get_by_role("link", name=link, exact=True).last)
        self._ready()

    @property
    def name(self) -> str:
        """Whose submission it is, as ``"Lovelace, Ada"``: hidden from whoever grades, but there."""
        return (self.page.locator(".breadcrumb a.name-shown").text_content() or "").strip()

    def give(
        self, cell: str, points: float | None = None, *, extra: float | None = None, comment: str = ""
    ) -> None:
        """Type points and a comment to a cell."""
        for field, kind, value in (
            (f"#{cell}", "grade", points),
            (f"#{cell}_extra_credit", "grade", extra),
            (f"#{cell}-comment", "comment", comment or None),
        ):
            if value is None:
                continue
            box = self.page.locator(field)
            box.fill("")
            with self.page.expect_response(_saves(kind)):
                box.press_sequentially(str(value))
                box.press("Tab")

    def next(self) -> None:
        """Press Next."""
        self._follow(self.page.locator("li.next a"))
        self._ready()

    def _follow(self, link: Locator) -> None:
        # The old page stays for a moment, and has links of the same names.
        before = self.page.url
        link.click()
        self.page.wait_for_url(lambda url: url != before)

    def _ready(self) -> None:
        self.page.wait_for_function(
            "typeof formgrader !== 'undefined' && formgrader.grades && formgrader.grades.loaded"
            " && formgrader.comments.loaded"
        )


def _saves(kind: str) -> Callable[[Response], bool]:
    def is_it(response: Response) -> bool:
        return response.request.method == "PUT" and f"/api/{kind}/" in response.url and response.ok

    return is_it
