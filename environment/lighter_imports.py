"""Make imports lighter: leave out of them what no node and no notebook needs.

Each Python program with a node imports, through the generated messages, two things that it never uses:

* ``rosidl_generator_py``, of which a message wants one small function, imports the generator of Python code with
  its parser and its templates (48 ms of processor time);
* ``service_msgs/msg/ServiceEventInfo``, which every node has through its type description service, imports numpy
  (65 ms) for a field that is set only where somebody makes such a message.

Each program that reads a notebook, JupyterLab and nbgrader among them, imports jsonschema, and through it
``rfc3987_syntax``, which compiles 32 grammars of internationalised addresses (1 to 3 s of processor time) for a check
that no notebook asks for.

All are imported here when they are asked for. Only the wheels in ``.venv`` are changed, never a ROS that was
sourced. A file that does not look as expected, as one of a later release may, is left alone.

Only the standard library is used: this runs during the set-up.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from environment.replacing import replace_content

if TYPE_CHECKING:
    from pathlib import Path

_MARK = "# Changed by the set-up of the course (environment/lighter_imports.py): "


@dataclass(frozen=True)
class Lighter:
    """A module that is to import something later.

    Attributes:
        file: the module, below site-packages.
        now: how it imports that now.
        later: what takes its place.
    """

    file: str
    now: re.Pattern[str]
    later: str


MODULES = (
    Lighter(
        "rosidl_generator_py/__init__.py",
        re.compile(r"^try:\n    from \.generate_py_impl import generate_py\n.*\Z", re.MULTILINE | re.DOTALL),
        _MARK
        + """the generator is imported where it is used.
def __getattr__(name):
    if name == 'generate_py':
        from .generate_py_impl import generate_py
        return generate_py
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
""",
    ),
    Lighter(
        "service_msgs/msg/_service_event_info.py",
        re.compile(r"^import numpy\b[^\n]*$", re.MULTILINE),
        _MARK
        + """numpy is imported where it is used.
class _Numpy:
    def __getattr__(self, name):
        import numpy
        return getattr(numpy, name)


numpy = _Numpy()""",
    ),
    Lighter(
        "rfc3987_syntax/__init__.py",
        re.compile(r"^from \.syntax_helpers import \*\s*\Z"),
        _MARK
        + """the grammars are compiled where one is used.
def is_valid_syntax(term, value):
    from .syntax_helpers import is_valid_syntax
    return is_valid_syntax(term, value)


def __getattr__(name):
    if name.startswith('_'):
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    from . import syntax_helpers
    return getattr(syntax_helpers, name)
""",
    ),
)


def make_lighter(site_packages: Path) -> list[Path]:
    """Change the modules that are there and not changed yet, each in one step, and return them."""
    changed = []
    for module in MODULES:
        path = site_packages / module.file
        if not path.is_file():
            continue
        text = path.read_text(encoding="utf-8")
        new = module.now.sub(lambda _, module=module: module.later, text, count=1)  # type: ignore[misc]
        if _MARK not in text and new != text:
            replace_content(path, new.encode())
            changed.append(path)
    return changed
