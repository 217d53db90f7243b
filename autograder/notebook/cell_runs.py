"""Follows the runs of the notebook's cells: which cell is running, and which definitions are out of date.

JupyterLab sends the id of the cell with each request to run it (``cellId`` in the request's metadata, which IPython
passes to ``pre_run_cell``). Other front ends, such as nbclient and the console, send no id. For these, the text of a
cell serves as its identifier.

A class or function is out of date if its cell has failed or now defines other names. If a cell fails, for example with
a ``SyntaxError``, the class from the previous run of the cell still exists, and a check would judge this old code. If
the cell never succeeded, there is no class, and the check cell fails with a misleading ``NameError``. If a class was
renamed, it also exists under the old name, and a check of the old name would pass although no cell contains this code
any more. If a class was corrected, the classes that other cells have derived from it before are still derived from the
class as it was.
"""

from __future__ import annotations

import dis
import hashlib
import importlib
import linecache
import re  # noqa: TID251  (a student's cells, in the student's kernel)
import traceback
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

from autograder import course, known_errors
from autograder.notebook.cell_output import last_student_line, notebook_shell, say, student_frames

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class TrackedRun:
    """One run of one cell.

    Attributes:
        cell: The identifier of the cell, which is the same in all its runs.
        number: A counter that grows with each run of any cell.
    """

    cell: str
    number: int

    def is_later_run_of(self, other: TrackedRun | None) -> bool:
        """Return True if this is a later run of the same cell as ``other``."""
        return other is not None and self.cell == other.cell and self.number > other.number


class CellTracker:
    """Knows which cell is running (``current``). Outside a notebook, ``current`` is always None."""

    def __init__(self) -> None:
        self.current: TrackedRun | None = None
        self._before_run: list[Callable[[TrackedRun], None]] = []
        self._shell: Any = notebook_shell()
        if self._shell is None:
            return
        self._shell.events.register("pre_run_cell", self._cell_begins)
        # No event announces the cell that imports this module, because it is already running. So note it here.
        kernel = getattr(self._shell, "kernel", None)
        request = (kernel.get_parent("shell") or {}) if kernel is not None else {}
        self._set_current(
            request.get("metadata", {}).get("cellId"), request.get("content", {}).get("code", "")
        )

    def before_each_run(self, action: Callable[[TrackedRun], None]) -> None:
        """Register a function that is called before each run of a cell."""
        self._before_run.append(action)

    def _cell_begins(self, info: Any) -> None:
        run = self._set_current(getattr(info, "cell_id", None), info.raw_cell or "")
        for action in self._before_run:
            action(run)

    def _set_current(self, cell_id: str | None, source: str) -> TrackedRun:
        number = 1 if self.current is None else self.current.number + 1
        self.current = TrackedRun(_identifier(cell_id, source), number)
        return self.current


def _identifier(cell_id: str | None, source: str) -> str:
    return cell_id or "text:" + hashlib.sha256(source.encode()).hexdigest()


class StaleCodeError(Exception):
    """A class or function is older than the code in its cell."""

    def _render_traceback_(self) -> list[str]:
        """Return only the message, because a traceback would point to the wrong cell. IPython calls this."""
        return [f"Not checked. {self}"]


def raise_if_stale(subject: Any) -> None:
    """Refuse to check a class or function that is older than its cell. Outside a notebook, do nothing.

    A check of files is never refused, because the student may have corrected the files in an editor. In that case this
    function only prints a warning.

    Raises:
        StaleCodeError: The subject, or a class or function that it uses, is older than its cell.
    """
    if _cells is None:
        return
    if isinstance(subject, (str, Path)):
        if why := _cells.why_missing(_ENTRY_POINTS):
            print(
                f"{why} So setup.py lacks the entry points of that cell. Correct the cell and run it, then check again."
            )
        return
    for name in (getattr(subject, "__name__", ""), *sorted(names_read(subject))):
        if why := _cells.why_missing(name):
            raise StaleCodeError(
                f"{why} The notebook still has an older {name}. Correct that cell and run it, then check again."
            )
    if why := _cells.why_older_than_its_parts(subject):
        raise StaleCodeError(why)


_ENTRY_POINTS = "entry_points"
"""The name of the list that a cell passes to ``package_files.add_entry_points``."""
_DEFINED = re.compile(rf"^(?:(?:class|(?:async\s+)?def)\s+(\w+)|({_ENTRY_POINTS})\s*=)", re.MULTILINE)
"""Matches the beginning of a definition in the text of a cell, even if Python cannot parse the cell."""
_CHECKED = r"^[^#\n]*\b(?:check|watch)\(.*\b{}\b"


@dataclass(frozen=True)
class _Failure:
    cell: str
    error: str


class _FailedCells:
    """Records which names the cells of a notebook failed to define, or do not define any more.

    Args:
        shell: IPython's shell.
    """

    def __init__(self, shell: Any) -> None:
        self._shell = shell
        self._source = ""
        self._before: dict[str, Any] = {}
        self._names_of: dict[str, set[str]] = {}
        self._failures: dict[str, _Failure] = {}
        self._made: dict[str, tuple[str, Any]] = {}
        self._dropped: dict[str, tuple[Any, list[str]]] = {}
        shell.events.register("pre_run_cell", self._cell_begins)
        shell.events.register("post_run_cell", self._cell_ended)
        usage_error = importlib.import_module("IPython.core.error").UsageError
        shell.set_custom_exc(
            (NameError, ImportError, AttributeError, TypeError, RuntimeError, SyntaxError, usage_error),
            self._show_error,
        )

    def why_missing(self, name: str) -> str:
        """Return why a class or function is out of date, in a sentence for the student; empty if it is up to date."""
        if failure := self._failures.get(name):
            return f"Your cell that defines {name} stopped before {name} was defined: {failure.error}"
        left, now = self._dropped.get(name, (None, []))
        if left is None or left is not self._shell.user_ns.get(name):
            return ""
        instead = f", it defines {' and '.join(now)}" if now else ""
        return f"Your cell does not define {name} any more{instead}. If another cell defines {name} now, run that one."

    def why_older_than_its_parts(self, subject: Any) -> str:
        """Return which class the subject is made from that has been corrected since; empty if there is none."""
        for made in filter(_is_of_a_cell, getattr(subject, "__mro__", ())):
            for part in filter(_is_of_a_cell, (*made.__bases__, *vars(made).values())):
                now = self._shell.user_ns.get(part.__name__)
                if _is_of_a_cell(now) and now not in subject.__mro__ and _text_of(now) != _text_of(part):
                    return (
                        f"{made.__name__} is made from {part.__name__}, and still from an older one: the cell with "
                        f"{part.__name__} ran later. Run the cell with {made.__name__}, then check again."
                    )
        return ""

    def _cell_begins(self, info: Any) -> None:
        self._source = info.raw_cell or ""
        known = self._names_of.get(_cell_of(info), set())
        self._before = {name: self._shell.user_ns.get(name) for name in known | _defined(self._source)}

    def _cell_ended(self, result: Any) -> None:
        if result.info is None:
            return
        cell, before = _cell_of(result.info), self._before
        self._before = {}
        self._failures = {name: one for name, one in self._failures.items() if one.cell != cell}
        error = result.error_before_exec or result.error_in_exec
        # IPython shows some errors by itself, such as `await` in a `def`, which only the compiler refuses.
        if result.error_before_exec and not getattr(error, "__notes__", ()) and (advice := _advice(error)):
            say(advice)
        known, variables = self._names_of.get(cell, set()), self._shell.user_ns
        names = self._names_of[cell] = set(before) if error else _defined(result.info.raw_cell or "")
        for name in names:
            if variables.get(name) is not before.get(name):
                self._made[name] = (cell, variables.get(name))
            if error is None or variables.get(name) is not before.get(name):
                self._failures.pop(name, None)
            else:
                words = filter(None, (_error_sentence(error), _advice(error)))
                self._failures[name] = _Failure(cell, " ".join(words))
        for name in known - names:
            # If another cell, an import or an assignment has defined the name since then, this newer definition is up
            # to date.
            maker, made = self._made.get(name, ("", None))
            if maker == cell and made is variables.get(name):
                self._dropped[name] = (made, sorted(names))

    def _show_error(self, shell: Any, kind: type, error: Exception, trace: Any, tb_offset: Any) -> None:
        del kind, tb_offset
        words = self._what_to_run(str(error.name)) if isinstance(error, NameError) else ""
        if (
            words and trace.tb_next is not None and trace.tb_next.tb_next is None
        ):  # the error was raised by the cell itself, not by a function that it calls
            error._render_traceback_ = lambda: [words]  # type: ignore[attr-defined]
        elif advice := _advice(error):
            if type(error).__name__ == "UsageError":  # IPython shows only the message
                error.args = (f"{error}\n{advice}",)
            error.add_note(advice)
        shell.showtraceback(running_compiled_code=not isinstance(error, SyntaxError))

    def _what_to_run(self, name: str) -> str:
        if not re.search(_CHECKED.format(re.escape(name)), self._source, re.MULTILINE):
            return ""
        why = self.why_missing(name)
        if why:
            return (
                f"NameError: there is no {name} yet. {why} Fix that cell and run it, then run this one again."
            )
        first = f"NameError: there is no {name} yet. Run the cell that defines {name} first, then run this one again."
        return f"{first} If you have run it, compare the names in both cells letter by letter."


def _cell_of(info: Any) -> str:
    return _identifier(getattr(info, "cell_id", None), info.raw_cell or "")


def _defined(source: str) -> set[str]:
    return set() if source.lstrip().startswith("%%") else {a or b for a, b in _DEFINED.findall(source)}


def _error_sentence(error: BaseException) -> str:
    """Return an error's type, line and message as a sentence."""
    message = error.msg if isinstance(error, SyntaxError) else str(error)
    raised_at = last_student_line(error)
    line = error.lineno if isinstance(error, SyntaxError) else raised_at and raised_at[1]
    named = type(error).__name__ + (f" in line {line}" if line else "")
    return (f"{named}, {message.rstrip('.?')}" if message else named) + "."


def _advice(error: BaseException) -> str:
    """Return what the table of known errors says about an error in a cell; empty if it does not know the error."""
    shown = traceback.format_exception(type(error), error, student_frames(error.__traceback__))
    try:
        packages = course.interfaces()
    except (OSError, course.NoCourse, course.BrokenChapter):  # a grader's kernel sees no course folder
        packages = ()
    row = known_errors.recognized("".join(shown), "cell", known_errors.packages(packages))
    return f"{row.means} {row.do}" if row else ""


def functions_of(subject: Any) -> list[FunctionType]:
    """Return a function itself, or the methods of a class."""
    own = vars(subject).values() if isinstance(subject, type) else (subject,)
    return [one for one in own if isinstance(one, FunctionType)]


def names_read(subject: Any) -> set[str]:
    """Return the global names that a function, or the methods of a class, use."""
    codes = [function.__code__ for function in functions_of(subject)]
    found = set()
    while codes:
        code = codes.pop()
        found |= {str(step.argval) for step in dis.get_instructions(code) if step.opname == "LOAD_GLOBAL"}
        codes += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
    return found


def _is_of_a_cell(value: Any) -> bool:
    return isinstance(value, type) and value.__module__ == "__main__" and value.__qualname__ == value.__name__


def _text_of(made: type) -> str:
    """Return the text of the cells that define the methods of a class; empty if it has none."""
    files = {function.__code__.co_filename for function in functions_of(made)}
    return "".join("".join(linecache.getlines(file)) for file in sorted(files))


_cells = _FailedCells(notebook_shell()) if notebook_shell() is not None else None
