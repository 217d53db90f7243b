"""Which addresses a link in a student's text may have on a page of feedback."""

from __future__ import annotations

import pytest
from bs4 import BeautifulSoup
from nbconvert.filters.markdown_mistune import markdown2html_mistune

from autograder.grading.returning.sanitize import harmless_markdown


def addresses(text: str) -> list[str]:
    """The addresses of all links on the page, as nbconvert makes it of what was kept of a text."""
    page = BeautifulSoup(markdown2html_mistune(harmless_markdown(text, ())), "html.parser")
    return [str(link["href"]) for link in page.find_all("a") if link.get("href")]


@pytest.mark.parametrize("form", ["[text]({})", '<a href="{}">text</a>'])
@pytest.mark.parametrize(
    "address",
    [
        "javascript:fired()",
        "JaVaScRiPt:fired()",
        "data:text/html,fired",
        "//elsewhere.example/",
        "vbscript:fired",
    ],
)
def test_a_link_that_runs_something_or_leads_aside_is_none(form: str, address: str) -> None:
    assert [found for found in addresses(form.format(address)) if not found.startswith("#")] == []


@pytest.mark.parametrize("form", ["[text]({})", '<a href="{}">text</a>'])
@pytest.mark.parametrize(
    "address", ["https://docs.ros.org/en/jazzy/", "mailto:ada@uni.example", "#part", "lab_1_3.html#part"]
)
def test_a_link_that_opens_a_page_stays(form: str, address: str) -> None:
    assert addresses(form.format(address)) == [address]
