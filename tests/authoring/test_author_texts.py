"""Each text for authors is told by some command, and each that is told is in the table."""

from __future__ import annotations

import re
from pathlib import Path

from autograder import authoring
from autograder.authoring.author_texts import TEXTS


def test_the_table_has_the_texts_that_the_code_names() -> None:
    code = "".join(file.read_text(encoding="utf-8") for file in Path(authoring.__path__[0]).glob("*.py"))
    told = re.findall(r'(?:author_text|\bbad)\(\s*"(\w+)"', code)
    told += re.findall(r'"(\w+)": ', code.partition("    troubles = {")[2].partition("}")[0])
    assert sorted(set(told)) == sorted(TEXTS)
