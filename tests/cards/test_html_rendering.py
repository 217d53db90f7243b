"""The HTML card: complete, well formed, harmless, and readable where a sanitiser took the styles away."""

from __future__ import annotations

import html
import os
import re
from dataclasses import dataclass, field, replace
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.cards.html_rendering import card_html
from autograder.cards.text_rendering import card_text
from autograder.verdict import CriterionResult, Diagnosis, Moment, State, Verdict, not_checked
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

GOLDEN = Path(__file__).parent / "golden"

HTML_TAGS = "bdi code details div li p pre small span strong style summary table tbody td th thead tr ul"
SVG_TAGS = "desc g line path svg text title"
TAGS = set(f"{HTML_TAGS} {SVG_TAGS}".split())
ARIA = "open aria-hidden aria-label aria-level role scope tabindex"
PLAIN = "class colspan data-name hidden lang style"
DRAWING = "d dx height text-anchor transform width x x1 x2 y y1 y2"
ATTRIBUTES = set(f"{ARIA} {PLAIN} {DRAWING}".split())


@dataclass
class Element:
    tag: str
    attributes: dict[str, str]
    parent: Element | None = None
    children: list[Element | str] = field(default_factory=list)

    def text(self) -> str:
        """All words of the element, as somebody without the style sheet reads them."""
        if self.tag in {"style", "title", "desc"}:
            return ""
        return " ".join(child if isinstance(child, str) else child.text() for child in self.children)

    def all(self, tag: str = "", css_class: str = "") -> list[Element]:
        found = []
        for child in self.children:
            if isinstance(child, Element):
                classes = child.attributes.get("class", "").split()
                if tag in {"", child.tag} and (not css_class or css_class in classes):
                    found.append(child)
                found += child.all(tag, css_class)
        return found

    def inside(self, css_class: str) -> bool:
        above = self.parent
        return above is not None and (
            css_class in above.attributes.get("class", "").split() or above.inside(css_class)
        )


class Tree(HTMLParser):
    """Parses strictly: every tag is closed, in order; a path or a line may close itself."""

    def __init__(self, source: str) -> None:
        super().__init__(convert_charrefs=True)
        self.root = self._open = Element("root", {})
        self._broken = False
        self.feed(source)
        self.close()
        assert self._open is self.root, f"<{self._open.tag}> is never closed"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert len({name for name, _ in attrs}) == len(attrs), f"<{tag}> repeats an attribute"
        element = Element(tag, {name: value or "" for name, value in attrs}, self._open)
        self._open.children.append(element)
        self._open = element

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "wbr":  # a place where a word may be broken: it is still one word
            self._broken = True
            return
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._open.tag == tag, f"</{tag}> closes <{self._open.tag}>"
        assert self._open.parent is not None
        self._open = self._open.parent

    def handle_data(self, data: str) -> None:
        before = self._open.children[-1] if self._open.children else None
        if self._broken and isinstance(before, str):
            self._open.children[-1] = before + data
        else:
            self._open.children.append(data)
        self._broken = False

    def handle_comment(self, data: str) -> None:
        raise AssertionError(f"a comment in the card: {data}")

    def handle_decl(self, decl: str) -> None:
        raise AssertionError(f"a declaration in the card: {decl}")


def words(element: Element) -> str:
    return " ".join(element.text().split())


def test_is_well_formed_and_made_of_harmless_parts_only(verdict: Verdict) -> None:
    tree = Tree(card_html(verdict)).root
    elements = tree.all()
    assert {element.tag for element in elements} <= TAGS
    assert {name for element in elements for name in element.attributes} <= ATTRIBUTES


def test_fetches_nothing_and_has_no_ids(verdict: Verdict) -> None:
    source = card_html(verdict)
    styles = "".join(str(child) for style in Tree(source).root.all("style") for child in style.children)
    styles += "".join(element.attributes.get("style", "") for element in Tree(source).root.all())
    for word in ("url(", "@import", "http:", "https:", "//", "expression(", "behavior"):
        assert word not in styles, word
    assert not re.search(r"<[^>]*\s(id|href|src|xlink:href)=", source)


def test_markup_in_the_words_stays_words(hostile: Verdict) -> None:
    tree = Tree(card_html(hostile)).root
    shown = words(tree)
    for text in (
        "<script>alert('title')</script> & \"quotes\"",
        "</td></table><img src=x onerror=alert(1)>",
        "{{ 7*7 }} {% raw %} </style><script>alert(2)</script> $x^2$ and $y$",
        "<b onmouseover=alert(4)>hover</b>",
        "seed \"'><script>",
    ):
        assert text in shown


def test_control_characters_are_written_out(hostile: Verdict) -> None:
    source = card_html(hostile)
    source.encode("utf-8")  # a lone surrogate would raise
    assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\u2028\u2029]", source)
    assert "\\x1b[31mred\\x1b[0m\\x00NUL" in source
    assert "\\u202edesrever \\u2066" in source
    assert "\\ud800" in source
    assert "l1\\nl2\\r\\tl3" in source


def test_a_flood_of_output_makes_no_flood_of_a_card(hostile: Verdict) -> None:
    flood = replace(hostile, detail="z" * 3_000_000, remarks=("r" * 1_000_000,))
    assert len(card_html(flood)) < 150_000


def test_every_criterion_is_a_row_with_its_words(verdict: Verdict) -> None:
    table = Tree(card_html(verdict)).root.all("table", "agc-table")
    if not verdict.criteria or verdict.nothing_seen:
        assert not table
        return
    rows = table[0].all("tr", "agc-row")
    assert len(rows) == len(verdict.criteria)
    for row, criterion in zip(rows, verdict.criteria, strict=True):
        text = words(row)
        assert text.startswith("✓ PASS" if criterion.passed else "✗ NOT YET")
        for said in (criterion.title, criterion.expected, criterion.seen):
            if len(said) < 160 and said.isprintable():
                assert " ".join(said.split()) in text
        highlighted = row.all(css_class="agc-seen")[0].all("strong")
        assert bool(highlighted) is not criterion.passed


@pytest.mark.parametrize(("name", "said"), cases(__file__, "the_head_says_how_it_stands"))
def test_the_head_says_how_it_stands(name: str, said: str, load: Callable[[str], Verdict]) -> None:
    tree = Tree(card_html(load(name))).root
    head = tree.all(css_class="agc-head")[0]
    badge = head.all(css_class="agc-badge")[0]
    assert badge.attributes["aria-hidden"] == "true"
    assert said in words(head)
    assert load(name).title in tree.all(css_class="agc")[0].attributes["aria-label"]


def test_what_could_not_be_checked_accuses_nobody(load: Callable[[str], Verdict]) -> None:
    for verdict in (load("not_checked"), not_checked("lab_1_2.talker", "The talker", 10.0, "")):
        shown = words(Tree(card_html(verdict)).root)
        assert "not your mistake" in shown
        assert "What to do next" in shown
        for accusation in ("NOT YET", "Not yet", "0 of 10", "What happened", "✗", "failed", "wrong"):
            assert accusation not in shown


def test_a_check_that_the_student_has_to_ask_for_otherwise_blames_nothing() -> None:
    asked = not_checked(
        "lab_1_2.taker", "", 0.0, "No exercise has this name.\nCorrect it.", key="unknown_exercise"
    )
    shown = words(Tree(card_html(asked)).root)
    assert "No exercise has this name." in shown
    assert "Correct it." in shown
    assert "trouble" not in shown
    assert "instructor" not in shown


def test_a_pass_is_met_with_a_warm_word_and_no_homework(load: Callable[[str], Verdict]) -> None:
    shown = words(Tree(card_html(load("talker_passed"))).root)
    assert "Well done" in shown
    assert "What to do next" not in shown


def test_a_failure_without_a_known_mistake_still_has_a_next_step() -> None:
    rate = CriterionResult("rate", "Publishes every 0.5 s", 5.0, False, "0.5 s", "1.0 s")
    for diagnosis in (None, Diagnosis("crashed", "It stopped.", " ")):
        verdict = Verdict("e", "E", State.FAILED, 0.0, 5.0, criteria=(rate,), diagnosis=diagnosis)
        shown = words(Tree(card_html(verdict)).root)
        assert 'What to do next Start with "Publishes every 0.5 s"' in shown


def test_words_in_a_picture_are_hidden_where_the_picture_is_taken_away(verdict: Verdict) -> None:
    """JupyterLab drops <svg> and <style> of an untrusted notebook and keeps the words inside an <svg>."""
    tree = Tree(card_html(verdict)).root
    for picture in tree.all("svg"):
        assert picture.inside("agc-pictures")
    for wrapper in tree.all(css_class="agc-pictures"):
        assert "hidden" in wrapper.attributes
        assert "display: none" in wrapper.attributes["style"]
    sheet = str(tree.all("style")[0].children[0])
    assert ".agc-pictures[hidden]:has(svg)" in sheet


def test_the_picture_has_its_twin_in_words(load: Callable[[str], Verdict]) -> None:
    verdict = load("three_ints_partial")
    tree = Tree(card_html(verdict)).root
    pictures = tree.all("svg", "agc-svg")
    assert len(pictures) == len({moment.part for moment in verdict.timeline})
    for picture in pictures:
        assert picture.attributes["role"] == "group"
        assert picture.attributes["aria-label"].startswith("Traffic ")
    table = words(tree.all("table", "agc-moments")[0])
    for moment in verdict.timeline:
        assert moment.label in table
        assert moment.part in table


def test_all_pictures_are_one_stop_of_the_keyboard_and_a_screen_reader_says_what_is_labelled(
    verdict: Verdict,
) -> None:
    tree = Tree(card_html(verdict)).root
    stops = [
        box
        for box in tree.all("div", "agc-pictures")
        for box in box.all("div")
        if "tabindex" in box.attributes
    ]
    assert len(stops) == len(tree.all("div", "agc-pictures"))
    for picture in tree.all("svg", "agc-svg"):
        marks = picture.all("svg", "agc-mark")
        assert not any("tabindex" in mark.attributes for mark in marks)
        told = [mark for mark in marks if mark.attributes.get("role") == "img"]
        assert len(told) == len(picture.all("text", "agc-label"))
        for mark in told:
            assert mark.attributes["aria-label"]
            assert not (mark.parent and mark.parent.attributes.get("aria-hidden"))
        # What is read with the eyes is the same, next to each mark.
        tips = [tip.text().strip() for tip in picture.all("text", "agc-tip")]
        assert len(tips) == len(marks)
        assert {mark.attributes["aria-label"] for mark in told} <= set(tips)


def test_no_picture_where_a_program_only_ended(load: Callable[[str], Verdict]) -> None:
    ended = Moment(0.3, "your code", "note", "exited")
    tree = Tree(card_html(replace(load("talker_passed"), timeline=(ended,)))).root
    assert not tree.all("svg", "agc-svg")
    assert "What was on the wire" not in words(tree)
    assert "exited" in words(tree.all("table", "agc-moments")[0])


def test_what_was_on_the_wrong_topic_is_grey_and_the_legend_says_why(load: Callable[[str], Verdict]) -> None:
    wrong = Moment(0.3, "/chater", "note", "your publisher is here", key=True, stray=True)
    meant = Moment(0.3, "/chatter", "note", "no publisher of yours", key=True)
    tree = Tree(card_html(replace(load("talker_wrong_topic"), timeline=(wrong, meant)))).root
    assert [text.text().strip() for text in tree.all("text", "agc-lane")] == ["/chater", "/chatter"]
    grey = [text.text().strip() for text in tree.all("text", "agc-stray")]
    assert grey == ["/chater", "your publisher is here"]
    assert "where it was not asked for" in words(tree)


def test_a_long_timeline_is_cut_and_says_so(hostile: Verdict) -> None:
    tree = Tree(card_html(hostile)).root
    rows = tree.all("table", "agc-moments")[0].all("td")
    assert 40 <= len(tree.all("svg", "agc-mark")) <= 82
    assert any("more left out here" in words(row) for row in rows)
    left_out = int(re.findall(r"(\d+) moments are left out in the middle", words(tree))[0])
    assert left_out + len(tree.all("svg", "agc-mark")) == len(hostile.timeline)


def test_one_card_looks_as_it_was_agreed(load: Callable[[str], Verdict]) -> None:
    """Run with ``UPDATE_GOLDEN=1`` after a change that is meant, and read the difference."""
    source = re.sub(r"<style>.*?</style>\n", "", card_html(load("talker_wrong_topic")), flags=re.DOTALL)
    path = GOLDEN / "talker_wrong_topic.html"
    if os.environ.get("UPDATE_GOLDEN"):
        path.write_text(source + "\n", encoding="utf-8")
    assert source + "\n" == path.read_text(encoding="utf-8")


def test_before_the_first_line_is_written_the_card_lists_what_is_asked(
    load: Callable[[str], Verdict],
) -> None:
    listed = Tree(card_html(load("talker_unsolved"))).root.all("div", "agc-asked")[0]
    assert words(listed).startswith("What is asked Publishes on the right topic (2 points)")
    assert "Keeps the rate (3 points) A timer or any other way to keep it." in words(listed)
    assert words(listed).endswith("Not graded: “log the string that it publishes”.")


def test_what_counts_is_folded_below_a_criterion_with_a_result(load: Callable[[str], Verdict]) -> None:
    verdict = load("talker_unsolved")
    tree = Tree(card_html(replace(verdict, nothing_seen=False))).root
    rate, whole = tree.all("details", "agc-counts")
    assert rate.inside("agc-criterion")
    assert words(rate) == f"what counts {verdict.criteria[-1].counts}"
    assert words(whole) == f"what else counts, and what does not {verdict.counts}"
    assert not Tree(card_html(load("talker_passed"))).root.all("details", "agc-counts")


def test_two_cards_share_a_page(load: Callable[[str], Verdict]) -> None:
    page = card_html(load("talker_passed")) + card_html(load("crashed"))
    assert len(Tree(page).root.all(css_class="agc")) == 2


def test_the_traceback_is_folded_under_its_last_line(load: Callable[[str], Verdict]) -> None:
    verdict = load("crashed")
    folded = Tree(card_html(verdict)).root.all("details")[-1]
    assert folded.attributes.get("open") == "open", "it is the diagnosis: nobody should have to look for it"
    summary = words(folded.all("summary")[0])
    assert summary == "The traceback, ending in: AttributeError: 'String' object has no attribute 'dta'"
    assert html.unescape(folded.all("pre")[0].text()).rstrip() == verdict.detail.rstrip()


@pytest.mark.parametrize(("advice", "codes"), cases(__file__, "code_in_the_advice_is_set_as_code"))
def test_code_in_the_advice_is_set_as_code(
    load: Callable[[str], Verdict], advice: str, codes: tuple[str, ...]
) -> None:
    verdict = load("talker_wrong_topic")
    assert verdict.diagnosis is not None
    card = Tree(card_html(replace(verdict, diagnosis=replace(verdict.diagnosis, next_step=advice)))).root
    (next_step,) = card.all(css_class="agc-next")
    assert [code.text() for code in next_step.all("code")] == list(codes)
    assert ("`" in next_step.text()) == (not codes)


def test_the_line_of_the_cell_stands_beside_the_diagnosis(load: Callable[[str], Verdict]) -> None:
    trace = """Traceback (most recent call last):
  File "/tmp/ipykernel_71/2831.py", line 11, in say_hello
    msg.dta = "Hello"
    ^^^^^^^
AttributeError: 'String' object has no attribute 'dta'"""
    (shown,) = Tree(card_html(replace(load("crashed"), detail=trace))).root.all(css_class="agc-place")
    assert words(shown) == (
        "Line 11 of your cell : msg.dta = \"Hello\" AttributeError: 'String' object has no attribute 'dta'"
    )


def test_a_second_try_shows_the_points_of_the_first(load: Callable[[str], Verdict]) -> None:
    verdict = replace(load("talker_wrong_topic"), score=8.0, max_score=10.0)
    (score,) = Tree(card_html(verdict, before=5.0)).root.all(css_class="agc-score")
    assert words(score) == "5 → 8 of 10 points"
    (same,) = Tree(card_html(verdict, before=8.0)).root.all(css_class="agc-score")
    assert words(same) == "8 of 10 points"


def test_a_card_that_is_out_of_date_says_why_and_is_dimmed(load: Callable[[str], Verdict]) -> None:
    tree = Tree(card_html(load("talker_passed"), notice="TalkerNode has changed since.")).root
    (card,) = tree.all(css_class="agc-dated")
    (notice,) = card.all(css_class="agc-notice")
    assert (words(notice), notice.attributes["role"]) == ("TalkerNode has changed since.", "status")


def test_a_screen_reader_is_told_the_result(verdict: Verdict) -> None:
    (spoken,) = Tree(card_html(verdict)).root.all(css_class="agc-spoken")
    assert spoken.attributes["role"] == "status"
    assert words(spoken)


def test_texts_that_differ_are_shown_as_a_difference(load: Callable[[str], Verdict]) -> None:
    text = CriterionResult(
        "text", "Says the right string", 2.0, False, "“Hello, world! 0”, …", "“Hello world 0”"
    )
    tree = Tree(card_html(replace(load("talker_wrong_topic"), criteria=(text,)))).root
    (shown,) = tree.all(css_class="agc-difference")
    assert "".join(words(shown).split()) == "thedifference:Hello[,]world[!]0"
    assert "missing" in card_text(replace(load("talker_wrong_topic"), criteria=(text,)))


def test_long_names_break_at_their_slashes(load: Callable[[str], Verdict]) -> None:
    name = CriterionResult("type", "Type", 1.0, False, "a/b", "my_robot_interfaces/srv/AddTwoInts")
    source = card_html(replace(load("talker_wrong_topic"), criteria=(name,)))
    assert "my_robot_interfaces/<wbr/>srv/<wbr/>AddTwoInts" in source


def test_a_short_card_has_points_what_happened_and_what_to_do_next_and_no_more(
    load: Callable[[str], Verdict],
) -> None:
    verdict = load("talker_wrong_topic")
    assert verdict.diagnosis is not None
    for shown in (
        html.unescape(card_html(verdict, short=True).partition("</style>")[2]),
        card_text(verdict, short=True),
    ):
        words = " ".join(re.sub(r"<wbr/>|`|<[^>]*>", "", shown).split())
        assert verdict.title in words
        assert "What to do next" in words
        assert verdict.seed not in words
        assert "Criteria" not in words
        assert "on the wire" not in words
