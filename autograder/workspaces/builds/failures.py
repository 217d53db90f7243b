"""Finds the line of a build's log that explains best why the build failed."""

from __future__ import annotations

import re2

_COMPILER = re2.compile(
    r"(?m)^(?P<file>[^\s:][^:\n]*):(?P<line>\d+):(?:\d+:)? (?:fatal )?error: (?P<what>.*)$"
)
_CMAKE = re2.compile(
    r"(?m)^CMake Error at (?P<file>[^:\n]+):(?P<line>\d+)[^\n]*:\n+(?P<what>[ \t]+\S.*(?:\n[ \t]+\S.*|\n\n  \S.*)*)"
)
_CMAKE_STATUS = re2.compile(r"(?m)^-- .*\n?")
_CALL_STACK = re2.compile(r"\n+Call Stack \(most recent call first\):(?P<calls>(?:\n[ \t]+\S.*)+)")
_CALL = re2.compile(r"^(?P<file>[^:\n]+):(?P<line>\d+)")
_CMAKE_PLAIN = re2.compile(r"(?m)^CMake Error: (?P<what>.*)$")
_PYTHON = re2.compile(r"(?m)^(?P<what>(?:[\w.]*(?:Error|Exception|Invalid\w+)|[\w.]+\.[A-Z]\w+)(?::.*)?)$")
_PLACE = re2.compile(r'(?m)^\s*File "(?P<file>[^"]+)", line (?P<line>\d+)')
_SETUPTOOLS = re2.compile(r"(?m)^error: (?P<what>.*)$")
_NINJA_MAKE = re2.compile(r"^(?:make|gmake|ninja|---|<<<|>>>)")


def telling_line(log: str) -> str:
    """Return the line of a log that explains best why a build failed, with file and line number if the log has them.

    Args:
        log: The output of colcon's commands, in order.

    Returns:
        One line; empty only if the log is empty.
    """
    if found := _COMPILER.search(log):
        return f"{_short(found['file'])}:{found['line']}: {found['what']}"
    python = _python(log)
    # Remove CMake's status lines, because they come from another stream and may appear between the lines of an error.
    log = _CMAKE_STATUS.sub("", log) or log
    if found := _CMAKE.search(log):
        # If CMake reports that a Python program that it called has failed, the cause is the error in that program.
        if python and "execute_process" in found["what"]:
            return python
        what = " ".join(found["what"].split())
        return f"{_place(found, log)}: {_first_sentences(what)}"
    if found := _CMAKE_PLAIN.search(log):
        return found["what"].strip()
    if python:
        return python
    if found := _SETUPTOOLS.search(log):
        return found["what"].strip()
    lines = [line.strip() for line in log.splitlines() if line.strip() and not _NINJA_MAKE.match(line)]
    return lines[-1] if lines else ""


def _python(log: str) -> str:
    # CalledProcessError only means that a program that colcon or CMake called has failed, so look for that program's
    # error.
    found = list(_PYTHON.finditer(log))
    errors = [error for error in found if "CalledProcessError" not in error["what"]] or found
    if not errors:
        return ""
    error = errors[-1]
    places = [place for place in _PLACE.finditer(log, 0, error.start()) if not _is_a_library(place["file"])]
    if not places:
        return error["what"].strip()
    file, line = places[-1]["file"], places[-1]["line"]
    # setuptools executes setup.py as a text, so tracebacks call the file "<string>".
    file = "setup.py" if file == "<string>" and "run_setup" in log else file
    return f"{_short(file)}:{line}: {error['what'].strip()}"


def _is_a_library(file: str) -> bool:
    return "site-packages" in file or "/lib/python3" in file or file.startswith("<frozen")


def _place(error: re2.Match[str], log: str) -> str:
    """Return the package's file and line that caused a CMake error, even if CMake names a library's file."""
    stack = _CALL_STACK.match(log, error.end())
    own = _CALL.search(stack["calls"].strip().splitlines()[-1].strip()) if stack else None
    place = own or error
    return f"{_short(place['file'])}:{place['line']}"


def _short(file: str) -> str:
    """Return the last two parts of a path: the package and the file."""
    return "/".join(file.split("/")[-2:])


def _first_sentences(text: str, limit: int = 240) -> str:
    return text if len(text) <= limit else text[: text.rfind(" ", 0, limit)] + " …"
