"""What people read: links lead somewhere, pictures have words, and nothing tells of the machine it was made on."""

from __future__ import annotations

import html
import json
import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import pytest

from autograder.masters.master_files import chapter_path, masters
from tests.cases import cases

ROOT = Path(__file__).resolve().parents[1]
MASTERS = masters(ROOT)
DOCS = sorted([*ROOT.glob("docs/*.md"), *ROOT.glob("docs/instructor/*.md")])
PAGES = sorted([*ROOT.glob("*.md"), *DOCS, *MASTERS])
NOTEBOOKS = sorted(ROOT.glob("chapters/*/*.ipynb"))
READ = [*PAGES, *NOTEBOOKS]
each = pytest.mark.parametrize("path", READ, ids=lambda path: str(path.relative_to(ROOT)))

FENCE = re.compile(r"^(?P<fence>`{3,}|~{3,})(?P<kind>.*?)^(?P=fence)`*[ \t]*$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
LINK = re.compile(
    r"(?P<image>!?)\[(?P<text>(?:[^\[\]]|\[[^\]]*\])*)\]\((?P<target>[^()\s]*(?:\([^()]*\)[^()\s]*)*)\)"
)
HTML_LINK = re.compile(r"""\b(?:href|src)=["'](?P<target>[^"']*)["']""")
HTML_IMAGE = re.compile(r"<img\b[^>]*>")


@cache
def markdown(path: Path) -> str:
    """The Markdown of a page or of all text cells of a notebook."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".ipynb":
        return text
    cells = json.loads(text)["cells"]
    return "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")


def prose(path: Path) -> str:
    """The Markdown without code, in which brackets mean something else."""
    return CODE.sub("", FENCE.sub("", markdown(path)))


@cache
def anchors(path: Path) -> frozenset[str]:
    """The anchors of a page's headings, as GitHub makes them, or as JupyterLab does for a notebook."""
    found: list[str] = []
    for line in FENCE.sub("", markdown(path)).splitlines():
        if not (heading := re.match(r"#{1,6} +(.*?)\s*#*$", line)):
            continue
        title = html.unescape(
            re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).replace("`", "").replace("*", "")
        )
        if path.suffix == ".ipynb":
            anchor = title.replace(" ", "-")
        else:
            anchor = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        again = found.count(anchor)
        found.append(anchor)
        if again:
            found.append(f"{anchor}-{again}")
    return frozenset(found)


def as_read(path: Path) -> Path:
    """Where a page's links start from: those of a master are followed in the chapter that is made of it."""
    if path.is_relative_to(ROOT / "solutions"):
        return chapter_path(ROOT, path)
    return path


def broken(path: Path, target: str) -> str:
    """What is wrong with a link, or nothing."""
    if target.startswith("attachment:"):
        return ""  # tests/masters/test_figures.py
    if re.match(r"[a-z]+:", target):
        return "" if target.startswith(("https://", "mailto:")) else f"{target}: not https"
    file, _, anchor = unquote(target).partition("#")
    read = path if file.endswith(".svg") else as_read(path)  # figures are beside the masters
    where = (read.parent / file).resolve() if file else path
    if not where.exists():
        return f"{target}: no such file"
    if not where.is_relative_to(ROOT):
        return f"{target}: outside of the course"
    if anchor and anchor not in anchors(where):
        return f"{target}: no such heading"
    return ""


@each
def test_every_link_leads_somewhere(path: Path) -> None:
    targets = [found["target"] for pattern in (LINK, HTML_LINK) for found in pattern.finditer(prose(path))]
    assert not [why for target in targets if (why := broken(path, target))]


OWN_SHELL = {ROOT / "docs" / f"{name}.md" for name in ("students-guide", "your-own-repository")}
"""The student's guide has JupyterLab's own terminal, and a repository of one's own an environment that is activated."""
IN_A_NEW_SHELL = sorted({*DOCS, ROOT / "README.md"} - OWN_SHELL)


@pytest.mark.parametrize("path", IN_A_NEW_SHELL, ids=lambda path: path.name)
def test_a_new_shell_finds_every_program_that_is_to_be_typed(path: Path) -> None:
    """The programs of the environment are in no search path: ``./course nbgrader …`` is, or the whole way to it."""
    bare = re.compile(r"^\$ (?:.*?(?:; do|;|&&|\|) )?(?:nbgrader|jupyter|autograder) .*", re.MULTILINE)
    assert not bare.findall(path.read_text(encoding="utf-8"))


@each
def test_every_picture_has_words(path: Path) -> None:
    text = prose(path)
    shown = [found for found in LINK.finditer(text) if found["image"]]
    # The words of a master's figure are in its SVG: a build refuses one that has none.
    silent = [
        found[0]
        for found in shown
        if len(found["text"].split()) < 3 and not (path in MASTERS and found["target"].endswith(".svg"))
    ]
    silent += [tag for tag in HTML_IMAGE.findall(text) if not re.search(r'alt="[^"]{10,}"', tag)]
    assert not silent


NAMED = re.compile(r"`((?:autograder|benchmarks|environment|tests)/[\w./-]*[\w/])`")
IN_THE_PACKAGE = re.compile(r"`((?:[a-z_]+/)+(?:\w+\.[\w.]+)?)`")


@pytest.mark.parametrize("path", [*DOCS, ROOT / "CONTRIBUTING.md"], ids=lambda path: path.name)
def test_every_file_that_a_page_names_is_there(path: Path) -> None:
    """The architecture names files as they are seen from the package, and in its table of a class from `grading/`."""
    text = FENCE.sub("", path.read_text(encoding="utf-8"))
    places = [ROOT]
    names = NAMED.findall(text)
    if path.stem == "architecture":
        places, names = [ROOT, ROOT / "autograder", ROOT / "autograder/grading"], IN_THE_PACKAGE.findall(text)
        assert len(names) > 20
    assert not [name for name in names if not any((place / name).exists() for place in places)]


def test_the_architecture_fits_on_two_screens() -> None:
    words = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8").split()
    assert sum(any(map(str.isalnum, word)) for word in words) <= 900  # the lines of a table are none


def test_pictures_are_small_and_shown_somewhere() -> None:
    shown = "\n".join(markdown(path) for path in READ)
    for picture in (ROOT / "docs/images").glob("*.png"):
        assert picture.stat().st_size < 300_000
        assert f"images/{picture.name}" in shown


def test_the_moving_picture_is_short_and_small_and_goes_on() -> None:
    film = (ROOT / "docs/images/lab.gif").read_bytes()
    assert "images/lab.gif" in markdown(ROOT / "README.md")
    assert len(film) < 1_200_000
    assert b"NETSCAPE2.0" in film
    # A graphic control extension per frame holds its time, in hundredths of a second.
    times = [
        int.from_bytes(found[1], "little")
        for found in re.finditer(rb"\x21\xf9\x04.(..).\x00", film, re.DOTALL)
    ]
    assert 12 <= sum(times) / 100 <= 25


def test_every_page_of_the_documentation_can_be_reached_from_the_readme() -> None:
    reached, ahead = set(), [ROOT / "README.md"]
    while ahead:
        page = ahead.pop()
        if page in reached or page.suffix != ".md" or not page.exists():
            continue
        reached.add(page)
        targets = (unquote(found["target"]).partition("#")[0] for found in LINK.finditer(prose(page)))
        ahead += [(page.parent / target).resolve() for target in targets if target and ":" not in target]
    assert not [page.name for page in DOCS if page not in reached]


# `me`, `you` and the like stand in examples, `ubuntu` is the user of the official image.
# `work` at the top is where a machine that builds keeps its clones.
HOMES = re.compile(
    rb"(?<![\w.$}/-])/(?:root|home/(?!(?:ada|me|student|ubuntu|user|you)\b)\w+|Users/\w+|work(?:space)?|builds?)/[\w.]"
)


def test_nothing_that_is_committed_names_a_folder_of_this_machine() -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    if listed.returncode:
        pytest.skip("this is no git clone")
    found = []
    for name in listed.stdout.decode().split("\0"):
        path = ROOT / name
        if not name or not path.is_file():
            continue
        found += [f"{name}: {match[0].decode()}" for match in HOMES.finditer(path.read_bytes())]
    assert not found


@pytest.mark.parametrize("folder", ["root", "home/" + "kim", "Users/" + "Kim", "work"])
def test_a_folder_of_this_machine_is_found(folder: str) -> None:
    assert HOMES.search(f'see "/{folder}/course/x.py"'.encode())
    assert not HOMES.search(f"see my/{folder}/course/x.py and /home/you/x".encode())


@pytest.mark.parametrize(("text", "wrong"), cases(__file__, "a_broken_link_is_found"))
def test_a_broken_link_is_found(text: str, wrong: bool) -> None:
    found = LINK.search(text)
    assert found is not None
    assert bool(broken(ROOT / "README.md", found["target"])) == wrong


LISTED = re.compile(r"^\| \[[^\]]*\]\((chapters/[^)]*)\).* \| (\d+) \| (\d+|to read) \|$", re.MULTILINE)


def test_the_readme_lists_each_notebook_with_its_minutes_and_points() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    true = {}
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        marks = [cell["metadata"].get("nbgrader", {}) for cell in cells]
        points = sum(mark["points"] for mark in marks if mark.get("grade"))
        minutes = re.search(r"\*(\d+) minutes ·", markdown(path))
        assert minutes
        true[str(path.relative_to(ROOT))] = (int(minutes[1]), points)
    listed = {
        file: (int(minutes), 0 if points == "to read" else int(points))
        for file, minutes, points in LISTED.findall(readme)
    }
    assert listed == true
    hours = round(sum(minutes for minutes, _ in true.values()) / 30) / 2
    assert f"{len(true)} notebooks, about {hours:g} hours".replace(".5", "½") in readme
    assert f"{sum(points for _, points in true.values())} points" in readme


def test_a_release_has_one_version_and_its_own_notes() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"[Version {version}](CHANGELOG.md)" in (ROOT / "README.md").read_text(encoding="utf-8")
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## [{version}] - " in changelog
    for release in changelog.split("\n## ")[1:]:
        assert sum(line.startswith("- ") for line in release.splitlines()) <= 25, release.partition("\n")[0]


def test_every_decision_has_a_date_and_an_end() -> None:
    text = (ROOT / "docs" / "decisions.md").read_text(encoding="utf-8")
    rows = text.partition("## In force")[2].partition("\n## ")[0].splitlines()
    decisions = [row for row in rows if row.startswith("| ")][2:]
    assert len(decisions) > 20
    assert not [
        row for row in decisions if not re.fullmatch(r"\| 20\d\d-\d\d-\d\d \| .+ \| .+ \| \S.*? \|", row)
    ]
