"""The pages that a person reads: nbgrader's feedback, with nothing in it that a browser executes or fetches.

``nbgrader_config.py`` of a class names these, so that ``autograder grade``, ``nbgrader generate_feedback`` and
formgrader all come through here.
"""

from __future__ import annotations

import functools
import re  # noqa: TID251  (a trusted template)
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbgrader
from jinja2 import pass_context
from nbconvert.exporters import HTMLExporter
from traitlets.config import Config

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.entering.nbgrader_guard import guard
from autograder.grading.returning.page_head import mark_waiting, with_summary, without_dead_links
from autograder.grading.returning.sanitize import clean, is_the_masters, make_harmless

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nbformat import NotebookNode

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
"""What a browser may do with a page: show its own text, styles and pictures (W3C, "Content Security Policy")."""

_OURS = Path(__file__).parent / "page_templates"
_FORMGRADER = Path(nbgrader.__file__).parent / "server_extensions" / "formgrader"
_NBGRADERS = _FORMGRADER / "templates"
_BOOTSTRAP = _FORMGRADER / "static" / "node_modules" / "bootstrap" / "dist" / "css"
_SCRIPT = re.compile(r"<script\b.*?</script\s*>", re.DOTALL | re.IGNORECASE)


class FeedbackExporter(HTMLExporter):
    """nbgrader's feedback page without scripts, for notebooks that nobody vouches for.

    nbgrader's own page loads MathJax from the network. Without it, formulas are shown as TeX.
    """

    @property
    def default_config(self) -> Config:
        """Our page, built upon nbgrader's."""
        config = Config(
            {
                "FeedbackExporter": {
                    "template_name": "autograder_feedback",
                    "extra_template_basedirs": [str(_OURS), str(_NBGRADERS)],
                    "extra_template_paths": [str(_NBGRADERS), str(_BOOTSTRAP)],
                }
            }
        )
        config.merge(super().default_config)
        return config

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        guard(self.parent)

    def default_filters(self) -> Iterator[tuple[str, Any]]:
        """The filters of nbconvert, with ours in their place."""
        filters: Any = super().default_filters
        yield from filters()
        yield "markdown2html", markdown_to_html
        yield "without_scripts", without_scripts
        yield "part_of_page", part_of_page
        yield "with_summary", with_summary

    def from_notebook_node(  # type: ignore[override]
        self, nb: NotebookNode, resources: dict[str, Any] | None = None, **kw: Any
    ) -> tuple[str, dict[str, Any]]:
        """Make the page of one notebook."""
        names = (resources or {}).get("nbgrader", {})
        if {"student", "assignment", "notebook"} <= set(names):
            converter: Any = self.parent
            mark_waiting(nb, ClassDirectory(Path(converter.coursedir.root)).gradebook_url, names)
        page: tuple[str, dict[str, Any]] = super().from_notebook_node(make_harmless(nb), resources, **kw)
        return page


@pass_context
def markdown_to_html(context: Any, source: str) -> str:
    """Stands for nbconvert's filter of that name; what does not come from the master word for word is cleaned.

    In ``nbgrader_config.py`` it is ``HTMLExporter.filters["markdown2html"]``, for formgrader.
    """
    rendered: str = _NBCONVERTS.markdown2html(context, source)
    return without_dead_links(rendered if is_the_masters(context.get("cell", {})) else clean(rendered))


def part_of_page(render: Callable[[], str], depends_on: Any) -> str:
    """A part of nbgrader's page; stands where an exporter may have another filter that remembers some of them.

    Args:
        render: Renders the part.
        depends_on: All that makes this part other than that of another page.
    """
    del depends_on
    return render()


# The same for all students of an assignment, and most of a page.
@functools.lru_cache(maxsize=16)
def without_scripts(head: str) -> str:
    """The head of a page without its scripts, and with the policy that forbids any other.

    Args:
        head: From a template that is trusted.
    """
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}" />'
    return _SCRIPT.sub("", head).replace("<head>", f"<head>\n{policy}", 1)


_NBCONVERTS = HTMLExporter()
