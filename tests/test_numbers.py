"""Every number of the README stands in the file that it comes from, and no page tells of another version."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
README = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
ACCURACY = " ".join((ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8").split())
PERFORMANCE = " ".join((ROOT / "docs" / "performance.md").read_text(encoding="utf-8").split())
IN_WORDS = {
    2: "two",
    3: "three",
    4: "four",
    5: "five",
    6: "six",
    7: "seven",
    8: "eight",
    9: "nine",
    10: "ten",
}
IN_NUMBERS = {word: number for number, word in IN_WORDS.items()}


def number(text: str) -> int:
    """A number as it stands in prose."""
    return IN_NUMBERS.get(text.lower()) or int(text)


def found(pattern: str, page: str) -> re.Match[str]:
    """The place of a page that holds a number."""
    match = re.search(pattern, page)
    assert match, f"no page says {pattern!r} any more: name the new source of README's number here"
    return match


def rates() -> str:
    """What the bank came to, from the file that ``tests.measure rates`` writes."""
    how, bank = json.loads((ROOT / "docs" / "accuracy.json").read_text(encoding="utf-8"))["bank"]
    accepted, rejected = (
        f"{bank[part]} of {bank[whole]}" for part, whole in (("accepted", "right"), ("rejected", "wrong"))
    )
    return (
        f"On {how['when']} the judge accepted [{accepted} right answers](docs/accuracy.md) of our own and rejected "
        f"{rejected} wrong ones."
    )


def blind() -> str:
    """What the blind answers came to; those that were wrong after all are no right answers."""
    right = found(r"Of the (\d+) right ones (\w+) lost points. (\w+) of them were wrong after all", ACCURACY)
    wrong = found(r"None of the (\d+) wrong ones passed", ACCURACY)
    later = found(
        r"On (\S+) (\d+) more wrong answers were written.*?(\d+) of them passed: (\w+) are left open.*?"
        r"the inputs of the other (\w+) did not show what is wrong, and (\w+) of them are rejected since",
        ACCURACY,
    )
    rare = found(
        r"On (\S+) (\d+) more, whose mistakes show only in rare cases, .*? and (\d+) wrong ones, "
        r"of which (\w+) are rejected",
        ACCURACY,
    )
    usual = found(
        r"Then came (\d+) with usual mistakes.*? and (\d+) wrong ones: .*? Of these, (\w+) are", ACCURACY
    )
    written, lost, mistaken = map(number, right.groups())
    return (
        f"Of {written - mistaken} right ones {IN_WORDS[lost - mistaken]} lost points; "
        f"of {wrong[1]} wrong ones none passed. On {later[1]}, {later[3]} of {later[2]} more wrong ones "
        f"passed: {later[4]} do what their tasks ask or leave open, {later[6]} others are rejected since. "
        f"On {rare[1]}, {rare[3]} of {rare[2]} with mistakes in rare cases and {usual[2]} of {usual[1]} with usual "
        f"ones passed; {number(rare[4]) + number(usual[3])} are rejected since."
    )


def mutants() -> str:
    """The weakest figure."""
    share = found(r"without those that do what the task asks \| `mutants` \| (\d+) of (\d+)", ACCURACY)
    return f"Of {share[2]} small errors made in right answers {share[1]} were rejected."


def times_of_cards() -> str:
    """How long a student with a wrong answer waits."""
    wrong = found(
        r"On a quiet machine .*?card of (\d+) wrong answers to chapter 1 came after ([\d.]+) s \(median\), "
        r"after (\d+) s for the 95th percentile",
        PERFORMANCE,
    )
    return (
        f"On a quiet machine, half of {wrong[1]} wrong answers to chapter 1 get their card within {wrong[2]} s, one in "
        f"twenty after more than {wrong[3]} s."
    )


def one_lab() -> str:
    """How long one lab of 120 students takes: the mean of the benchmark's class, and Labs 1.2 and 1.4 on two cores."""
    results = json.loads((ROOT / "benchmarks" / "results.json").read_text(encoding="utf-8"))
    seconds = found(r"\(([\d.]+) s a notebook, feedback included", json.dumps(results))[1]
    least, most = (
        round(120 * float(seconds) / 60),
        round(120 * float(found(r"\| all \| ([\d.]+) \|", PERFORMANCE)[1]) / 2 / 60),
    )
    when = found(r"Measured on (\S+) in \d+ minutes, full form", PERFORMANCE)[1]
    return (
        f"One lab of 120 students takes [{IN_WORDS[least]} to {IN_WORDS[most]} minutes](docs/performance.md#figures) "
        f"on two cores ({when})."
    )


def repairs() -> str:
    """How many things the set-up changes in the wheels."""
    page = (ROOT / "docs" / "environment.md").read_text(encoding="utf-8")
    number_of = found(r"changes (\w+) things in the wheels", page)[1]
    return f"[{number_of} repairs](docs/environment.md"


@pytest.mark.parametrize("sentence", [repairs, rates, blind, mutants, times_of_cards, one_lab])
def test_the_readme_says_what_its_source_says(sentence: object) -> None:
    assert callable(sentence)
    assert sentence() in README


def test_the_performance_page_begins_with_the_figure_that_it_holds() -> None:
    seconds = found(r"\(([\d.]+) s a notebook, feedback included", PERFORMANCE)[1]
    assert f"{seconds} seconds for each notebook" in PERFORMANCE
    assert f"120 × {seconds} s = {120 * float(seconds) / 60:.1f} minutes" in PERFORMANCE


@pytest.mark.parametrize("words", ["something failed", "thirteen notebooks", "what the chapter teaches"])
def test_no_page_says(words: str) -> None:
    pages = [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]
    assert not [str(page.relative_to(ROOT)) for page in pages if words in page.read_text(encoding="utf-8")]


def words_of(text: str) -> int:
    """How many words a reader sees: no picture, no address of a link."""
    for hidden in (r"(?s)<!--.*?-->", r"!\[[^\]]*\]\([^)]*\)", r"(?<=\])\([^)]*\)"):
        text = re.sub(hidden, "", text)
    return sum(any(map(str.isalnum, word)) for word in text.split())


def test_the_readme_and_its_first_screen_are_short() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    first, _, _ = text.partition("\n## ")
    assert words_of(first) <= 60
    assert words_of(text) <= 900
