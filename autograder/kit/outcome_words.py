"""The words for how a goal ended, and whether somebody says them of a goal.

Any human language is right, and a number is as good as a name. So what is recognised here is only what nobody may
say: a word that names another end than the goal's, where it is plainly said of the goal. A wish, a doubt, a legend and
an empty box say nothing of it.
"""

from __future__ import annotations

import re2

CANCELED = r"(?:cancel+ed|abgebrochen|annul\w*)"
SUCCEEDED = r"(?:succeeded|success)"
ABORTED = "aborted"
ACCEPTED = r"(?:accepted|akzeptiert|angenommen|aceptad[ao])"
DOUBTFUL = (
    r"not |n't|refus|reject|fail|nicht|unable|could|instead|denied|unknown|expect|want|but|should|neither|\bnor\b|never"
    r"|without|too late|ignor|before|despite|in spite|although|weder|\bohne|\bnie\b|zu spät|trotz"
)
"""Words of who says that something is otherwise than it was meant to be."""
DENIAL = r"\b(?:not?|n?or|neither|never|without|nein|nicht|kein|weder|false|if|unless)\b|\bun"
"""Words that deny an end, or leave it open."""
SUCCESS = r"succe|erfolg"
"""Words in which success is spoken of."""

_LIST = re2.compile(r"[\[(][^\[\]()\pL]*\d[\s,;][^\[\]()\pL]*[\])]|\[\]|\(\)")
_EMPTY_BOX = re2.compile(r"(?:\[\s+\]|\(\s+\)|[☐✗✘❌])\s*(?:\d+\W{1,3})?\w+")
_YES, _NO = r"(?:true|yes|ja|oui|sí|si)", r"(?:false|no|nein|non)"
_QUESTION = r"(?i)(?P<question>[^\s,;:=?.|(){}][^,;:=?.|(){}]*?)[\"']?\s*(?:=|:|->|\bis\b|\bwas\b|\bist\b|\?)+\s*[\"']?"
_ANSWERED = re2.compile(rf"{_QUESTION}(?P<flag>{_YES}|{_NO})\b")
"""A question and its yes or no, as in ``canceled=True`` and in "goal canceled as asked: no"."""
_DENIED = re2.compile(rf"{_QUESTION}{_NO}\b")
_WISH = r"(?i)\bask|request|to be|want|expect|should|hope"
_NOT = r"(?i)\bnot\b|\bnot_|n't|\bnicht\b"


def without_lists(line: str) -> str:
    """A line without the sequences in it: their numbers are no status. A single number in brackets is no sequence."""
    return _LIST.sub("", line)


def without_denied(line: str) -> str:
    """A line without each question that it answers by no, as in ``canceled=False``."""
    return str(_DENIED.sub("", line))


def names_canceled(line: str) -> bool:
    """True if a line speaks of canceling."""
    return re2.search(r"(?i)cancel|abgebrochen|annul", without_lists(line)) is not None


def flag(word: str, line: str) -> bool | None:
    """The line's answer, yes or no, to the question whether a goal ended so; None where it says neither.

    Args:
        word: One of the words above.
        line: What was said.
    """
    for found in _ANSWERED.finditer(line):
        question = found["question"]
        named = re2.search(rf"(?i)(?:\b|_){word}", question)
        # "canceled successfully" asks whether it was canceled.
        if not named or (word == SUCCEEDED and names_canceled(question)):
            continue
        before = question[: named.start()]
        if not re2.search(_WISH, before):
            yes = re2.fullmatch(f"(?i){_YES}", found["flag"]) is not None
            return yes != (re2.search(_NOT, before) is not None)
    return None


def ends_as(word: str, line: str) -> bool:
    """True if a line says that the goal ended so: "the goal was canceled", "status: CANCELED", "Canceled (5)"."""
    plain = _EMPTY_BOX.sub("", _ANSWERED.sub("", without_lists(line)))
    if re2.search(f"(?i){DOUBTFUL}", plain) or _names_another(word, plain):
        return False
    of_the_goal = r"\b(?:goal|it|ziel)\s+(?:is |was |has been |got |wurde |ended as |ended )?"
    of_its_status = r"\b(?:status|state|zustand|outcome|result)\s*(?:is|was|=|:)?[\s\d()\[\]'\"=:-]*"
    if re2.match(rf"(?i)[^\pL\pN]*{word}\s*(?:[,;.!(|-]|$)", plain):
        return True
    return any(
        not re2.match(r"(?i)\s+after\b|\s*(?:=|:|->|\?)", plain[found.end() :])
        for found in re2.finditer(rf"(?i)(?:{of_the_goal}|{of_its_status}){word}\b", plain)
    )


def _names_another(word: str, line: str) -> bool:
    """True if a line names another end beside this one, so that it is a legend or a comparison."""
    if word == SUCCEEDED:
        return names_canceled(line) or re2.search(f"(?i){ABORTED}", line) is not None
    return re2.search(r"\bSUCCEEDED\b" if word == CANCELED else f"(?i){SUCCESS}", line) is not None
