"""Shows the output of a launch on the screen and in its log folder, in the form of Jazzy's launch."""

from __future__ import annotations

import datetime
import os
import socket
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Mapping

_LOG_FILE = "launch.log"
_SOURCES = ("stdout", "stderr", "both")
_DESTINATIONS = ("screen", "log", "own_log")
# The short names for the destinations of a process's output.
_ALIASES: Mapping[str, Mapping[str, set[str]]] = {
    "screen": {"both": {"screen"}},
    "log": {"both": {"log"}, "stderr": {"screen"}},
    "both": {"both": {"log", "screen"}},
    "own_log": {"both": {"own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
    "full": {"both": {"screen", "log", "own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
}


@dataclass(frozen=True)
class OutputPlan:
    """The destinations of a process's lines.

    Attributes:
        places: The places that get each line, the screen and the log, for stdout and stderr.
        files: The names of the process's own log files that get each line, for stdout and stderr.
    """

    places: Mapping[str, frozenset[str]]
    files: Mapping[str, tuple[str, ...]]


def output_plan(process_name: str, output: str | Mapping[str, object]) -> OutputPlan:
    """Return the destinations that the `output` option of a process names.

    Args:
        process_name: The name of the process, such as `talker-1`, which is also the name of its own log files.
        output: screen, log, both, own_log or full; or a dictionary with the keys stdout, stderr and both.

    Raises:
        ValueError: The option has none of these values.
    """
    if isinstance(output, str):
        if output not in _ALIASES:
            raise ValueError(f'{output} is not a valid standard output config i.e. "screen", "log" or "both"')
        chosen = dict(_ALIASES[output])
    else:
        chosen = {source: _destinations(source, given) for source, given in output.items()}
    both = chosen.get("both", set())
    places, files = {}, {}
    for source in ("stdout", "stderr"):
        own = chosen.get(source, set())
        places[source] = frozenset((own | both) - {"own_log"})
        files[source] = tuple(
            name
            for name, wanted in (
                (f"{process_name}-{source}.log", "own_log" in own),
                (f"{process_name}.log", "own_log" in both),
            )
            if wanted
        )
    return OutputPlan(places, files)


def _destinations(source: str, given: object) -> set[str]:
    if source not in _SOURCES:
        raise ValueError(f'{source} is not a valid output source i.e. "stdout", "stderr" or "both"')
    names = {given} if isinstance(given, str) else set(given)  # type: ignore[call-overload]
    for name in names:
        if name not in _DESTINATIONS:
            raise ValueError(f'{name} is not a valid output destination i.e. "screen", "log" or "own_log"')
    return names


def _log_base() -> str:
    """Return the folder for all logs: ROS_LOG_DIR, or else log in ROS_HOME, whose default is ~/.ros."""
    folder = os.environ.get("ROS_LOG_DIR")
    if not folder:
        folder = os.path.join(os.environ.get("ROS_HOME") or os.path.join("~", ".ros"), "log")  # noqa: PTH118
    return os.path.normpath(os.path.expanduser(folder))  # noqa: PTH111


@dataclass
class Screen:
    """The screen and the log files of one launch. Log files exist only after `open_log`."""

    debug: bool = False
    folder: str | None = None
    _files: dict[str, TextIO] = field(default_factory=dict)

    def open_log(self) -> None:
        """Make the log folder of this launch, and the link `latest` to it.

        Raises:
            RuntimeError: The folder cannot be made.
        """
        base = _log_base()
        stamp = datetime.datetime.now().strftime("%Y-%m-%d-%H-%M-%S-%f")
        self.folder = f"{base}/{stamp}-{socket.gethostname()}-{os.getpid()}"
        try:
            os.makedirs(self.folder)  # noqa: PTH103
        except OSError as error:
            raise RuntimeError(
                f"the log folder {self.folder} can not be made ({error.strerror}): "
                "set ROS_LOG_DIR to a folder that can be written"
            ) from error
        self._link_latest(base)

    def _link_latest(self, base: str) -> None:
        """Let the link `latest` lead to this launch. Ignore an error: another launch may do the same right now."""
        link = f"{base}/latest"
        try:
            if os.path.islink(link):  # noqa: PTH114
                os.unlink(link)  # noqa: PTH108
            if not os.path.exists(link):  # noqa: PTH110
                os.symlink(str(self.folder), link, target_is_directory=True)  # noqa: PTH211
        except OSError:
            pass

    def _write(self, file_name: str, text: str) -> None:
        if self.folder is None:
            return
        if file_name not in self._files:
            self._files[file_name] = open(f"{self.folder}/{file_name}", "a", encoding="utf-8")  # noqa: PTH123, SIM115
        self._files[file_name].write(f"{text}\n")
        self._files[file_name].flush()

    def log(self, level: str, name: str, message: str) -> None:
        """Show a message of the launch itself.

        Args:
            level: DEBUG, INFO, WARNING or ERROR.
            name: The source of the line: launch, launch.user or the name of a process.
            message: The text of the message.
        """
        if level == "DEBUG" and not self.debug:
            return
        text = f"[{level}] [{name}]: {message}"
        print(text, flush=True)
        self._write(_LOG_FILE, f"{time.time():.7f} {text}")

    def output(self, plan: OutputPlan, source: str, line: str, shown: str) -> None:
        """Show or write one line of a process.

        Args:
            plan: The destinations.
            source: stdout or stderr.
            line: The line as the process wrote it.
            shown: The line in the form in which it is shown, with the name of the process before it.
        """
        places = plan.places[source]
        if "screen" in places:
            print(shown, flush=True)
        if "log" in places:
            self._write(_LOG_FILE, f"{time.time():.7f} {shown}")
        for file_name in plan.files[source]:
            self._write(file_name, line)

    def close(self) -> None:
        """Close the files."""
        for file in self._files.values():
            file.close()
        self._files.clear()
