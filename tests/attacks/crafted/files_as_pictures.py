# family = "reading"
# tries = "Text and outputs name files of the class and of the host wherever whoever makes the page could put a file's content: pictures, attachments, style sheets, entities, includes and templates."
# could_earn = "The class secret or the master on the page that goes back, read outside of any box."
# undefended = "With nbconvert's embedded pictures, the recording of the solution stands in the page, in base64."

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

NAMED = (
    "![a]({0})",
    "![a](file://{0}) ![b](attachment:{0}) <img src='{0}'> <img src='file://{0}'>",
    "<object data='{0}'></object> <embed src='{0}'> <iframe src='file://{0}'></iframe> <link rel=stylesheet href='{0}'>",
    "<style>@import url('{0}'); @font-face {{src: url(file://{0})}} body {{background: url('{0}')}}</style>",
    "```{{include}} {0}\n```\n\n```{{literalinclude}} {0}\n```\n\n```{{raw}} html\n:file: {0}\n```\n\n.. include:: {0}",
    "{{% include '{0}' %}} {{{{ open('{0}').read() }}}} {{% import '{0}' as x %}} {{{{ self.__init__.__globals__ }}}}",
    "\\input{{{0}}} $\\input{{{0}}}$ $\\includegraphics{{{0}}}$ <!--#include file='{0}' --> [[{0}]]",
    "<svg xmlns:xlink='http://www.w3.org/1999/xlink'><image xlink:href='{0}'/><use href='{0}#x'/></svg>",
)
RECORDED = "solutions/01_ros2_fundamentals/lab_1_2/talker.reference.json"
"""For a page that is made in the folder of the course: nbconvert embeds only what is below the current one."""
DRAWN = (
    "<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY x SYSTEM 'file://{0}'>]>"
    "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xi='http://www.w3.org/2001/XInclude' width='9' height='9'>"
    "<text>&x;</text><xi:include parse='text' href='{0}'/><image href='file://{0}'/></svg>"
)


def hand_in(folder: Path, notebook: Any) -> None:
    top = folder.parents[2]
    kept = [".autograder/secret", "source/planted/notes.md", "downloaded/planted/notes.txt", "gradebook.db"]
    for path in (*(str(top / name) for name in kept), "../../../source/planted/notes.md", RECORDED):
        for named in NAMED:
            text = named.format(path)
            cell = nbformat.v4.new_markdown_cell(text)
            cell.attachments = {path: {"image/png": path, "image/svg+xml": DRAWN.format(path)}}
            shown = [{"text/markdown": text}, {"text/html": text}, {"text/latex": text}, {"image/png": path}]
            notebook.cells += [cell, nbformat.v4.new_raw_cell(text)]
            notebook.cells.append(
                nbformat.v4.new_code_cell(
                    "from IPython.display import display\n"
                    f"for one in {shown!r}:\n    display(one, raw=True)\n"
                    f"display({{'image/svg+xml': {DRAWN.format(path)!r}}}, raw=True)\n"
                    f"display({{'image/jpeg': {base64.b64encode(path.encode()).decode()!r}}}, raw=True)"
                )
            )
    notebook.metadata["template"] = notebook.metadata["toc"] = {"base": str(top / kept[0])}
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
