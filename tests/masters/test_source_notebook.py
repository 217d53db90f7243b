"""The source notebook of a master has all the metadata that nbgrader needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.masters.master_cells import MASTER_HEADER
from autograder.masters.source_notebooks import Points, source_notebook

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from nbformat import NotebookNode


def by_id(notebook: NotebookNode) -> dict[str, NotebookNode]:
    return {cell.id: cell for cell in notebook.cells}


def test_a_tag_is_all_an_author_types(course: Path, ten_points: Points) -> None:
    cells = by_id(source_notebook(course / "solutions/01_first/lab_9_1/lab.md", points=ten_points))
    names = [name for name in cells if not name.startswith("text-")]
    assert names == ["given-given", "double", "given-write-it", "lab_9_1-double"]
    flags = {name: cells[name].metadata.nbgrader for name in names}
    assert {name: (f.grade, f.solution, f.locked) for name, f in flags.items()} == {
        "given-given": (False, False, True),
        "double": (False, True, False),
        "given-write-it": (False, False, True),
        "lab_9_1-double": (True, False, True),
    }
    assert [f.get("points") for f in flags.values()] == [None, None, None, 10]
    assert all(
        f.grade_id == name and f.schema_version == 3 and f.cell_type == "code" for name, f in flags.items()
    )


def test_points_come_from_the_exercise(course: Path) -> None:
    cells = by_id(source_notebook(course / "solutions/01_first/lab_9_1/lab.md", points=lambda check: 2.5))
    assert cells["lab_9_1-double"].metadata.nbgrader.points == 2.5


def test_no_metadata_depends_on_the_machine(course: Path, ten_points: Points) -> None:
    notebook = source_notebook(course / "solutions/01_first/lab_9_1/lab.md", points=ten_points)
    assert notebook.metadata.kernelspec.name == "python3"
    assert "version" not in notebook.metadata.language_info
    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)


def test_a_corrected_typo_changes_no_name_but_its_own(
    write_master: Callable[[str], Path], ten_points: Points, course: Path
) -> None:
    path = course / "solutions/01_first/lab_9_1/lab.md"
    before = source_notebook(path, points=ten_points)
    text = path.read_text()
    path.write_text(
        text.replace("import math", "import math as m").replace("Some text.", "Some better text.")
    )
    after = source_notebook(path, points=ten_points)
    changed = [(a.id, b.id) for a, b in zip(before.cells, after.cells, strict=True) if a.id != b.id]
    assert len(changed) == 1
    assert changed[0][0].startswith("text-")


def test_a_new_section_changes_no_name_elsewhere(course: Path, ten_points: Points) -> None:
    path = course / "solutions/01_first/lab_9_1/lab.md"
    before = set(by_id(source_notebook(path, points=ten_points)))
    new = "+++\n\n## New\n\n```{code-cell} ipython3\nprint(1)\n```\n\n## Write it"
    path.write_text(path.read_text().replace("## Write it", new))
    after = set(by_id(source_notebook(path, points=ten_points)))
    assert {name for name in after - before if not name.startswith("text-")} == {"given-new"}
    assert not before - after


def test_equal_cells_have_different_ids(write_master: Callable[[str], Path], ten_points: Points) -> None:
    cell = "```{code-cell} ipython3\nprint(1)\n```\n"
    notebook = source_notebook(
        write_master(f"## One\n\n{cell}\n{cell}\nsame\n\n+++\n\nsame\n"), points=ten_points
    )
    assert len({cell.id for cell in notebook.cells}) == len(notebook.cells)
    assert [c.id for c in notebook.cells if c.cell_type == "code"] == ["given-one", "given-one-2"]


def test_a_heading_inside_code_is_no_section(write_master: Callable[[str], Path], ten_points: Points) -> None:
    text = "## Real\n\n```bash\n# not a heading\n```\n\n```{code-cell} ipython3\nprint(1)\n```\n"
    assert "given-real" in by_id(source_notebook(write_master(text), points=ten_points))


def test_hints_open_one_at_a_time(course: Path, ten_points: Points) -> None:
    notebook = source_notebook(course / "solutions/01_first/lab_9_1/lab.md", points=ten_points)
    text = next(cell.source for cell in notebook.cells if "Hint 1" in cell.source)
    first, second = text.index("Hint 1 of 2."), text.index("Hint 2 of 2.")
    # The first is not closed before the second begins: the second is inside it.
    assert "</details>" not in text[first:second]
    assert text.count("<details>") == text.count("</details>") == text.count("</blockquote>") == 2
    assert ":::" not in text


def test_code_in_the_question_of_a_hint_is_shown_as_code(
    write_master: Callable[[str], Path], ten_points: Points
) -> None:
    """In a line of HTML no Markdown is read."""
    master = write_master(":::{hint} What goes into `__init__`?\nTwo lines.\n:::\n")
    (cell,) = [one for one in source_notebook(master, points=ten_points).cells if "Hint" in one.source]
    assert "What goes into <code>__init__</code>?</summary>" in cell.source


def test_text_between_two_hints_ends_their_run(
    write_master: Callable[[str], Path], ten_points: Points
) -> None:
    hint = ":::{hint} Why?\nBecause.\n:::\n"
    notebook = source_notebook(
        write_master(f"{hint}\nIn between.\n\n{hint}\nAt the end.\n"), points=ten_points
    )
    text = notebook.cells[0].source
    assert text.count("Hint 1 of 1.") == 2
    assert text.index("</details>") < text.index("In between.") < text.rindex("<details>")
    assert text.rindex("</details>") < text.index("At the end.")


def test_the_last_cell_links_to_the_neighbours_and_at_the_ends_of_a_chapter_to_all(
    course: Path, ten_points: Points
) -> None:
    chapter = course / "solutions/01_first"
    for lab, title in (("lab_9_0", "Before it"), ("lab_9_2", "After it")):
        (chapter / lab).mkdir()
        (chapter / lab / "lab.md").write_text(f"{MASTER_HEADER}# {title}\n")
    (chapter / "chapter.toml").write_text('labs = ["lab_9_2", "lab_9_1", "lab_9_0"]')
    other = course / "solutions/02_second"
    (other / "lab_9_9").mkdir(parents=True)
    (other / "chapter.toml").write_text('title = "More"')
    (other / "lab_9_9" / "lab.md").write_text(f"{MASTER_HEADER}# Far away\n")
    (course / "docs").mkdir()
    (course / "docs/learning-outcomes.md").write_text(
        "".join(
            f"| {can} | [a task](../chapters/x/{lab}.ipynb) |\n"
            for can, lab in (("add", "lab_9_1"), ("double", "lab_9_1"))
        )
    )
    last = {
        lab: source_notebook(chapter / lab / "lab.md", points=ten_points).cells[-1].source
        for lab in ("lab_9_2", "lab_9_1", "lab_9_0")
    }
    first, middle, end = (last[lab] for lab in ("lab_9_2", "lab_9_1", "lab_9_0"))
    assert middle == "← Previous: [After it](lab_9_2.ipynb) · Next: [Before it](lab_9_0.ipynb) →"
    assert first.endswith("</details>\n\nNext: [Lab 9.1: Doubling](lab_9_1.ipynb) →")
    way_out = "Next: [Far away](../02_second/lab_9_9.ipynb) →"
    assert end.endswith(f"</details>\n\n← Previous: [Lab 9.1: Doubling](lab_9_1.ipynb) · {way_out}")
    assert [line for line in first.splitlines() if line.startswith(("- ", "**"))][1:] == [
        "- [After it](lab_9_2.ipynb)",
        "- [Lab 9.1: Doubling](lab_9_1.ipynb): add; double",
        "- [Before it](lab_9_0.ipynb)",
        "**More**",
        "- [Far away](../02_second/lab_9_9.ipynb)",
    ]
