"""The making of a feedback page: nbgrader's template, with nothing in it that a browser executes or fetches."""

from __future__ import annotations

import functools
import hashlib
import re  # noqa: TID251  (a trusted template)
from collections import OrderedDict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import nbgrader
import re2
from bs4 import BeautifulSoup
from jinja2 import pass_context
from nbconvert.exporters import HTMLExporter
from nbconvert.exporters.templateexporter import TemplateExporter
from nbconvert.filters.highlight import Highlight2HTML
from nbconvert.filters.markdown_mistune import MarkdownWithMath
from nbconvert.filters.widgetsdatatypefilter import WidgetsDataTypeFilter
from nbconvert.preprocessors import CSSHTMLHeaderPreprocessor
from nbformat import NotebookNode
from traitlets.config import Config

from autograder.grading.rebuilding import nodes
from autograder.grading.rebuilding.rebuild import is_check, is_the_masters
from autograder.grading.returning.page_head import cards_first, with_summary, without_dead_links
from autograder.grading.returning.sanitize import Renderer, clean, make_harmless

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
"""The rights of a browser on a page: show its own text, styles and pictures (W3C, "Content Security Policy")."""

_OURS = Path(__file__).parents[1] / "page_templates"
_FORMGRADER = Path(nbgrader.__file__).parent / "server_extensions" / "formgrader"
_NBGRADERS = _FORMGRADER / "templates"
_BOOTSTRAP = _FORMGRADER / "static" / "node_modules" / "bootstrap" / "dist" / "css"
_SCRIPT = re.compile(r"<script\b.*?</script\s*>", re.DOTALL | re.IGNORECASE)
_REMEMBERED = 1024
"""Pieces of code; the given cells of a chapter are a few hundred."""
_REMEMBERED_CHARACTERS = 8_000_000
"""Of rendered parts of pages; those that the students of a chapter share have about a million."""
_PICTURE = re2.compile(r"(?i)<img\b[^>]*")
_SHOWS_ATTACHED = re2.compile(r'(?P<before><img\b(?:\s+[\w-]+="[^"]*")*?\s+)src="attachment:(?P<name>[^"]*)"')
_ALTERNATIVE = re2.compile(r"(?i)\salt=")


class Remembered:
    """A cache of values by what they were made of; the longest unused is forgotten first.

    Args:
        characters: Of all texts together, at most.
    """

    def __init__(self, characters: int) -> None:
        self._left = characters
        self._texts: OrderedDict[bytes, str] = OrderedDict()

    def get(self, of: Any, make: Callable[[], str]) -> str:
        """The text that was made of exactly this, made now where it is not known.

        Args:
            of: All that the text depends on, as JSON has it.
            make: Makes the text.
        """
        # Students write a part of it: a hash for which nobody can find two values, and not the values themselves.
        key = hashlib.sha256(msgspec.json.encode(of)).digest()
        known = self._texts.get(key)
        if known is not None:
            self._texts.move_to_end(key)
            return known
        text = make()
        self._texts[key] = text
        self._left -= len(text)
        while self._left < 0:
            _, forgotten = self._texts.popitem(last=False)
            self._left += len(forgotten)
        return text


class PageExporter(HTMLExporter):
    """nbgrader's feedback page without scripts, for notebooks that cannot be trusted.

    nbgrader's own page loads MathJax from the network. Without it, formulas are shown as TeX. The parts that many
    students share are rendered once. Nbconvert copies and validates a notebook twice on its way to the template, for
    preprocessors that may change it. Here there are none, so the template is rendered from the notebook itself.
    """

    @property
    def default_config(self) -> Config:
        """Our page, built upon nbgrader's."""
        config = Config(
            {
                "PageExporter": {
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
        self._parts = Remembered(_REMEMBERED_CHARACTERS)
        self._preprocessors: list[Any] = []
        css: Any = CSSHTMLHeaderPreprocessor(config=self.config)
        register: Any = self.register_preprocessor
        register(css, enabled=True)
        self._set_filter("markdown2html", markdown_to_html)

    def default_filters(self) -> Iterator[tuple[str, Any]]:
        """The filters of nbconvert, with ours in their place."""
        filters: Any = super().default_filters
        yield from filters()
        yield "without_scripts", without_scripts
        yield "with_summary", with_summary
        yield "cards_first", cards_first

    def page(self, notebook: NotebookNode, names: Mapping[str, Any]) -> str:
        """Make the page of one notebook.

        Args:
            notebook: As it is in ``autograded/``, with points and comments filled in; it is changed.
            names: What the template asks of the student, the notebook and the points.
        """
        language = notebook.metadata.get("language_info", {})
        lexer = language.get("pygments_lexer", language.get("name", None))
        self._set_filter("highlight_code", _highlighter(lexer))
        self._set_filter("part_of_page", functools.partial(self._part, lexer))
        resources = self._resources.copy()
        resources["nbgrader"] = dict(names)
        rendered: str = self.template.render(nb=make_harmless(notebook), resources=resources)
        return _with_alternative_texts(rendered.lstrip("\r\n"))

    @functools.cached_property
    def _resources(self) -> dict[str, Any]:
        """The resources that nbconvert hands to a template: the same for all, so made for an empty notebook."""
        initialise: Any = self._init_resources
        names = {"notebook": "", "score": 0.0, "max_score": 0.0, "late_penalty": 0.0}
        # Below it nbconvert looks for custom/custom.css; without it, below the current folder.
        resources: dict[str, Any] = initialise({"nbgrader": names, "config_dir": str(_OURS)})
        shown: Any = WidgetsDataTypeFilter(notebook_metadata={}, parent=self, resources=resources)
        self._set_filter("filter_data_type", shown)
        convert: Any = TemplateExporter.from_notebook_node  # HTMLExporter's would parse the page anew
        _, resources = convert(self, nodes.notebook([], {}), resources)
        return resources

    def _part(self, lexer: str | None, render: Callable[[], str], depends_on: Any) -> str:
        if isinstance(depends_on, NotebookNode) and is_check(depends_on):
            return render()  # its card is this student's
        return self._parts.get((lexer, depends_on), render)

    def _set_filter(self, name: str, function: Callable[..., Any]) -> None:
        register: Any = self.register_filter
        register(name, function)


@pass_context
def markdown_to_html(context: Any, source: str) -> str:
    """Stands for nbconvert's filter of that name; what does not come from the master word for word is cleaned.

    In ``nbgrader_config.py`` it is ``HTMLExporter.filters["markdown2html"]``, for formgrader. A picture that is not
    attached is left out: nbconvert would make no page at all.
    """
    cell = context.get("cell", {})
    rendered = MarkdownWithMath(renderer=Renderer(escape=False)).render(source)
    harmless = rendered if is_the_masters(cell) else clean(rendered)
    # Neither nbgrader's pages nor nbconvert's classic template keep a picture within its column.
    page = without_dead_links(harmless.replace("<img ", '<img style="max-width: 100%" '))
    attached = dict(cell.get("attachments", {}))
    return _with_pictures(page, attached.get if is_the_masters(cell) else attached.pop)


def _with_pictures(page: str, take: Callable[[str, dict[str, str]], Mapping[str, str]]) -> str:
    """A piece of a page with the pictures that are attached to its cell.

    Args:
        page: HTML in which a picture is the name of an attachment.
        take: Takes an attachment by its name. A student's is there once: a page must not swell.
    """

    def shown(tag: Any) -> str:
        kind, data = next(iter(take(tag["name"], {}).items()), ("", ""))
        return f'{tag["before"]}src="data:{kind};base64,{data}"' if data else tag["before"]

    return _SHOWS_ATTACHED.sub(shown, page)


# The same for all students of an assignment, and most of a page.
@functools.lru_cache(maxsize=16)
def without_scripts(head: str) -> str:
    """The head of a page without its scripts, and with the policy that forbids any other.

    Args:
        head: From a template that is trusted.
    """
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}" />'
    return _SCRIPT.sub("", head).replace("<head>", f"<head>\n{policy}", 1)


@functools.lru_cache(maxsize=8)
def _highlighter(lexer: str | None) -> Any:
    """Nbconvert's highlighter, with a memory of the code that it has seen."""
    make: Any = Highlight2HTML
    highlight = make(pygments_lexer=lexer)

    @functools.lru_cache(maxsize=_REMEMBERED)
    def highlighted(source: str, language: str | None, magics: str | None) -> Any:
        return highlight(source, language, {"magics_language": magics} if magics else {})

    def filtered(source: str, language: str | None = None, metadata: Any = None) -> Any:
        return highlighted(source, language, (metadata or {}).get("magics_language"))

    return filtered


def _with_alternative_texts(page: str) -> str:
    """The last step of nbconvert on a whole page, which parses it anew, also where no picture lacks words."""
    if all(_ALTERNATIVE.search(picture[0]) for picture in _PICTURE.finditer(page)):
        return page
    soup = BeautifulSoup(page, features="html.parser")
    for picture in soup.select("img:not([alt])"):
        picture.attrs["alt"] = "No description has been provided for this image"
    return str(soup)
