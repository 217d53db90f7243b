"""The code that the notebooks print is code: each block is read by what it is for."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import textwrap
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from autograder.masters.master_files import chapter_path, lab_name, masters
from autograder.notebook.package_files import PACKAGE
from autograder.notebook.robot_package import PROGRAMS

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(
    r"^(?P<indent>[ ]*)```(?P<language>\w+)\n(?P<code>.*?)^(?P=indent)```$", re.MULTILINE | re.DOTALL
)


def blocks() -> list[tuple[str, str, str]]:
    """Name of the notebook, language and code of every block that a notebook prints."""
    found = []
    for master in masters(ROOT):
        cells = json.loads(chapter_path(ROOT, master).read_text())["cells"]
        text = "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
        found += [(lab_name(master), match["language"], match["code"]) for match in FENCE.finditer(text)]
    return found


BLOCKS = blocks()
LAUNCH = [
    (name, language, code)
    for name, language, code in BLOCKS
    if language in ("xml", "yaml") and ("<launch>" in code or code.startswith("launch:"))
]


@pytest.mark.parametrize(
    ("name", "language", "code"),
    BLOCKS,
    ids=[f"{name}-{language}-{place}" for place, (name, language, _) in enumerate(BLOCKS)],
)
def test_a_block_is_what_it_says(name: str, language: str, code: str) -> None:
    match language:
        case "bash":
            subprocess.run(["bash", "-n"], input=code, text=True, check=True, capture_output=True)
        case "python":
            ast.parse(textwrap.dedent(code))
        case "xml":
            ElementTree.fromstring(f"<all>{code}</all>")
        case "yaml":
            yaml.safe_load(code)
        case "text":
            pass  # what a program prints
        case _:
            pytest.fail(f"Nobody knows how to read {language} in {name}.")


def test_the_launch_files_start_the_programs_of_the_package() -> None:
    started = []
    for _, language, code in LAUNCH:
        if language == "xml":
            nodes = [dict(node.attrib) for node in ElementTree.fromstring(code).iter("node")]
        else:
            nodes = [entry["node"] for entry in yaml.safe_load(code)["launch"]]
        started.append([(node["pkg"], node["exec"], node["output"]) for node in nodes])
    assert started == [[(PACKAGE, program, "screen") for program in PROGRAMS]] * 2
