"""What a student's text may do on a page of feedback, and that none of its words is lost there."""

from __future__ import annotations

import pytest
from bs4 import BeautifulSoup
from nbconvert.filters.markdown_mistune import markdown2html_mistune

from autograder.grading.returning.sanitize import clean, harmless_markdown


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


@pytest.mark.parametrize(
    "text",
    [
        "The listener hears <topic> and List<int>, if a<b then …",
        "<topic> is a name, <!> and </topic > are none",
        "<div>\nList<int> and Map<str, List<int>>\n</div>",
        "if 3 <4 and 5> 4",
    ],
)
def test_what_looks_like_a_tag_can_be_read(text: str) -> None:
    page = BeautifulSoup(markdown2html_mistune(harmless_markdown(text, ())), "html.parser")
    words = text.replace("<div>\n", "").replace("\n</div>", "")
    assert " ".join(page.get_text().split()) == words
    assert page.find("topic") is None


@pytest.mark.parametrize("value", ["{}", "'{}'", '"<{}>"', "x'{}'"])
def test_formatting_that_stays_open_is_not_opened_in_each_block(value: str) -> None:
    """A parser of HTML would make millions of elements of it."""
    opened = "".join(f"<b a={value.format(number)}>" for number in range(1_000))
    text = f"<div>{opened}</div>{'<p>x' * 2_000}"
    assert len(clean(text)) < 5 * len(text)
    assert len(clean("<p><b>x</b> <code>y</code></p>" * 1_500)) == 1_500 * 30, "closed formatting stays"


def test_a_control_character_is_shown_as_a_question_mark() -> None:
    assert clean("a\x1b[31m\x07b\tc\nd") == "a?[31m?b\tc\nd"
