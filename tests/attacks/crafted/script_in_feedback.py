# family = "forging"
# tries = "Scripts, frames, event handlers and links to scripts stand wherever a page of feedback may show them: text, outputs, names, attachments, errors, table cells."
# could_earn = "Code in the instructor's browser, who is logged in to formgrader: any grade."
# undefended = "In plain nbconvert pages, all of it is executed."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

EVIL = (
    "<script>attack_canary()</script>",
    "<img src=x onerror='attack_canary()'>",
    "<iframe srcdoc='<script>attack_canary()</script>'></iframe>",
    "<svg onload=attack_canary()><script>attack_canary()</script></svg>",
    "[a](javascript:attack_canary()) <a href='javascript:attack_canary()'>b</a>",
    "</textarea></pre></div><object data='data:text/html,attack_canary'></object>",
    "<form action='javascript:attack_canary()'><input autofocus onfocus=attack_canary()>",
    "$\\href{javascript:attack_canary()}{x}$ <math href='javascript:attack_canary()'>x</math>",
    "<style>@import 'javascript:attack_canary()';</style><link rel=import href='data:text/html,attack_canary'>",
)


def hand_in(folder: Path, notebook: Any) -> None:
    for evil in EVIL:
        notebook.cells.insert(1, nbformat.v4.new_markdown_cell(evil))
        notebook.cells.append(nbformat.v4.new_code_cell(f"print({evil!r})\nraise ValueError({evil!r})"))
        shown = (
            f"from IPython.display import HTML, SVG, Javascript, Markdown, display\ndisplay(HTML({evil!r}))"
        )
        notebook.cells.append(nbformat.v4.new_code_cell(f"{shown}\ndisplay(Markdown({evil!r}))"))
        notebook.cells.append(nbformat.v4.new_raw_cell(evil))
    named = nbformat.v4.new_code_cell("1")
    named.metadata["nbgrader"] = {"grade_id": EVIL[0], "grade": False, "solution": True, "locked": False}
    notebook.cells.append(named)
    notebook.cells[0].attachments = {EVIL[1]: {"text/html": EVIL[0], "image/svg+xml": EVIL[3]}}
    notebook.metadata["title"] = notebook.metadata["authors"] = EVIL[0]
    folder.joinpath("lab_1_2.ipynb").write_text(nbformat.writes(notebook), encoding="utf-8")
