"""The names that authors import from the kit: few, documented, and each with an example that runs."""

import re
from pathlib import Path
from random import Random

import pytest

from autograder import course, kit

PAGE = (course.root() / "docs/kit.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_the_face_is_small_and_each_name_has_an_example_and_a_sentence() -> None:
    prose = re.sub(r"```python\n.*?```", "", PAGE, flags=re.DOTALL)
    examples = "\n".join(BLOCKS)
    assert len(kit.__all__) <= 40
    assert [name for name in kit.__all__ if f"`{name}`" not in prose] == []
    assert [name for name in kit.__all__ if not re.search(rf"\b{name}\b", examples)] == []


def test_types_and_places_are_the_same_names() -> None:
    source = Path(kit.__file__).read_text(encoding="utf-8")
    for_types = re.findall(r"^    from (autograder\.kit\.\S+) import (.*)$", source, re.MULTILINE)
    listed = {name: module for module, names in for_types for name in names.split(", ")}
    assert listed == kit._MODULES
    assert sorted(listed) == sorted(kit.__all__)


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.split("(")[0].strip()[:20])
def test_an_example_runs(block: str) -> None:
    names = {name: getattr(kit, name) for name in kit.__all__}
    exec(compile(block, "docs/kit.md", "exec"), {**names, "random": Random(8)})


def test_an_unknown_name_is_an_ordinary_error() -> None:
    with pytest.raises(ImportError, match="cannot import name 'Hear'"):
        exec("from autograder.kit import Hear")
