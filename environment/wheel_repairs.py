"""Repairs the installed wheels: CMake files, imports, parameters, executors, action clients, Fast DDS.

* **CMake files.** The wheels were built in a container. What CMake exports for the Python part of a message package
  names that container's folders, ``/opt/python/cp311-cp311/include/python3.11`` and numpy's headers below it, and
  CMake stops with "non-existent path in its INTERFACE_INCLUDE_DIRECTORIES". They are pointed at this interpreter's, by
  the Python of the environment: ``.venv/bin/python -m environment.wheel_repairs``.
* **Imports.** Each Python program with a node imports, through the generated messages, two things that it never uses:
  ``rosidl_generator_py``, of which a message wants one small function, imports the generator of Python code with its
  parser and its templates (48 ms of processor time); ``service_msgs/msg/ServiceEventInfo``, which every node has
  through its type description service, imports numpy (65 ms) for a field that is set only if a program makes such a
  message. Each program that reads a notebook, JupyterLab and nbgrader among them, imports jsonschema, and through it
  ``rfc3987_syntax``, which compiles 32 grammars of internationalised addresses (1 to 3 s of processor time) for a
  check that no notebook asks for. All are imported when they are asked for.
* **Callbacks of parameters.** rclpy asks a node's own callbacks about ``use_sim_time``, too, which the judge sets on a
  running node. A node that refuses what it does not know would not follow the judge's clock, and a node that takes each
  value for its speed would drive at ``True``. So only rclpy itself is asked about ``use_sim_time``, as if it had been
  set before the node had a callback.
* **Threads.** rclpy's ``MultiThreadedExecutor`` gives its pool a callback again and again until a thread begins it, and
  meanwhile its loop goes round without a pause, so that the threads rarely get the interpreter's lock. On an idle
  machine, a node with two threads answered a service after 0.2 s (median) to 2.5 s, and as fast as with one thread when
  the machine was busy. Upstream: https://github.com/ros2/rclpy/issues/1452. A callback is queued once, and the loop
  waits up to 1 ms for it.
* **Signals.** An executor looks whether its context is valid, and then makes what it waits with. If the signal of
  ``kill`` arrives in between, the program ends with a traceback, ``RCLError: … the given context is not valid``, and
  not with the ``ExternalShutdownException`` that programs catch. The executor raises that exception here, too.
* **Action clients.** The wheel that is called rclpy 7.1.6 contains the code of 7.1.5, whose ``ActionClient`` sends a
  request first and notes its number afterwards. If another thread spins, it may take the answer in between: it does
  not find the number, logs "Ignoring unexpected goal response", and the future is never done. The same happens to
  cancel requests and results. Upstream: https://github.com/ros2/rclpy/issues/1123. A lock per client lets no thread
  take answers while another one is sending.
* **Fast DDS** can hang for ever in a node that ends while another one appears. A thread that deletes a participant
  waits for the callback of discovery that is just running. It waits "for ever", with ``time_point::max()`` as its
  deadline. As the wheels are built, this deadline is converted into time of day, and overflows into the past:
  ``pthread_cond_timedwait`` refuses it each time without releasing the mutex, the callback never gets the mutex, and
  the program keeps a core busy until it is killed. On Ubuntu's Jazzy nothing is converted. Upstream:
  https://github.com/eProsima/Fast-DDS/issues/6513. The two functions that ask for such a wait get a deadline in 68
  years instead. That is one number in each, and nothing else of the library changes.

Only the wheels in ``.venv`` are changed, never a ROS that was sourced. A file that does not look as expected, as one
of a later release may, is left alone; one that is repaired already is not changed again. Only the standard library is
used: this runs during the set-up.
"""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

_BUILD_PYTHON = r"/opt/python/cp\d+-cp\d+t?"
_PYTHON_INCLUDE = re.compile(_BUILD_PYTHON + r"/include/python3\.\d+t?")
_NUMPY_INCLUDE = re.compile(_BUILD_PYTHON + r"/lib/python3\.\d+t?/site-packages/numpy/_?core/include")
_LEFT_OVER = re.compile(r"/opt/python/[^\s\";]+")
FOR_EVER = (2**63 - 1).to_bytes(8, "little")
"""``std::chrono::seconds::max()``."""
YEARS_68 = (2**31 - 1).to_bytes(8, "little")
"""This many seconds from now, in nanoseconds of either clock, stay below 2**63 until the year 2194."""
_JUMP = rb"\xe9.{4}"
_BOTH = re.compile(
    # set_listener(listener) and set_listener(listener, mask) of a DomainParticipant: each puts the default timeout
    # into a register (movabs into rdx and rcx) and jumps to the function that takes one.
    rb"(\x48\xba)%(number)b(%(jump)b\x90\x48\xb9)%(number)b(%(jump)b)"
    % {b"number": re.escape(FOR_EVER), b"jump": _JUMP},
    re.DOTALL,
)


class RepairError(Exception):
    """The file names an unknown folder of the build container, or headers are missing."""


@dataclass(frozen=True)
class HeaderFolders:
    """The folders of this interpreter's headers."""

    python: Path
    numpy: Path

    @classmethod
    def here(cls) -> HeaderFolders:
        """Return the folders of the interpreter that runs this.

        Raises:
            RepairError: One of the folders does not exist.
        """
        import numpy

        folders = cls(Path(sysconfig.get_path("include")), Path(numpy.get_include()))
        for header in (folders.python / "Python.h", folders.numpy / "numpy" / "arrayobject.h"):
            if not header.exists():
                raise RepairError(f"The header {header} is missing: install the header files of Python.")
        return folders


def repaired_cmake(text: str, headers: HeaderFolders) -> str:
    """Return the text of a CMake file with the container's header folders replaced by this interpreter's.

    Raises:
        RepairError: Another folder of the container is named.
    """
    # Replaced by a function, because a backslash in a path must not be read as a reference to a group.
    text = _NUMPY_INCLUDE.sub(lambda _: headers.numpy.as_posix(), text)
    text = _PYTHON_INCLUDE.sub(lambda _: headers.python.as_posix(), text)
    left_over = _LEFT_OVER.search(text)
    if left_over:
        raise RepairError(f"a folder of the build machine that has no counterpart here: {left_over.group()}")
    return text


def repair_cmake(prefix: Path, headers: HeaderFolders) -> list[Path]:
    """Repair every CMake file that the wheels installed below `prefix`. Return the files that were changed.

    Each file is replaced in one step: after an interruption, running again goes on from there.

    Raises:
        RepairError: A file names a folder that this program does not know; the message says which file.
    """
    changed = []
    for path in sorted(prefix.glob("share/*/cmake/**/*.cmake")):
        # The bytes outside the two paths are left alone, whatever their encoding.
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        try:
            new = repaired_cmake(text, headers)
        except RepairError as error:
            raise RepairError(f"{path}: {error}") from None
        if new != text:
            _replace_content(path, new.encode("utf-8", "surrogateescape"))
            changed.append(path)
    return changed


@dataclass(frozen=True)
class SourceRepair:
    r"""A change of a Python module.

    Attributes:
        file: The module, below site-packages.
        now: The text that is replaced.
        change: A sentence that says what the change does. It is written into the module, to show that it is repaired.
        later: The text that replaces it, as a template of ``re``: ``\g<name>`` is a group of ``now``, and ``{mark}`` is
            the comment with ``change``.
    """

    file: str
    now: re.Pattern[str]
    change: str
    later: str

    def repaired(self, text: str) -> str:
        """Return the module's text with the change, or as it is if it has it already or looks otherwise."""
        mark = f"# Changed by the set-up of the course (environment/wheel_repairs.py): {self.change}"
        return text if mark in text else self.now.sub(self.later.replace("{mark}", mark), text, count=1)


SOURCE_REPAIRS = (
    SourceRepair(
        "rosidl_generator_py/__init__.py",
        re.compile(r"^try:\n    from \.generate_py_impl import generate_py\n.*\Z", re.MULTILINE | re.DOTALL),
        "the generator is imported when it is used.",
        """{mark}
def __getattr__(name):
    if name == 'generate_py':
        from .generate_py_impl import generate_py
        return generate_py
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
""",
    ),
    SourceRepair(
        "service_msgs/msg/_service_event_info.py",
        re.compile(r"^import numpy\b[^\n]*$", re.MULTILINE),
        "numpy is imported when it is used.",
        """{mark}
class _Numpy:
    def __getattr__(self, name):
        import numpy
        return getattr(numpy, name)


numpy = _Numpy()""",
    ),
    SourceRepair(
        "rfc3987_syntax/__init__.py",
        re.compile(r"^from \.syntax_helpers import \*\s*\Z"),
        "the grammars are compiled when one is used.",
        """{mark}
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
    SourceRepair(
        "rclpy/node.py",
        re.compile(
            r"^        modified_parameter_list = self\._call_pre_set_parameters_callback\(parameter_list\)$",
            re.M,
        ),
        "only rclpy is asked about use_sim_time.",
        """        {mark}
        if [parameter.name for parameter in parameter_list] == ['use_sim_time']:
            own = (
                self._pre_set_parameters_callbacks,
                self._on_set_parameters_callbacks,
                self._post_set_parameters_callbacks,
            )
            self._pre_set_parameters_callbacks = []
            self._on_set_parameters_callbacks = [self._time_source._on_parameter_event]
            self._post_set_parameters_callbacks = []
            try:
                return self._set_parameters_atomically_common(parameter_list)
            finally:
                (
                    self._pre_set_parameters_callbacks,
                    self._on_set_parameters_callbacks,
                    self._post_set_parameters_callbacks,
                ) = own

        modified_parameter_list = self._call_pre_set_parameters_callback(parameter_list)""",
    ),
    SourceRepair(
        "rclpy/executors.py",
        re.compile(
            r"^            self\._executor\.submit\(handler\)\n            self\._futures\.append\(handler\)$",
            re.MULTILINE,
        ),
        "a callback that waits for a thread is not queued again.",
        """            {mark}
            from concurrent.futures import wait
            turn = getattr(handler, '_turn', None)
            if turn is None:
                self._futures.append(handler)
            if turn is None or turn.done():
                turn = handler._turn = self._executor.submit(handler)
            # Without this wait, the loop would hold the interpreter's lock, and no thread would take the data.
            wait([turn], timeout=0.001)""",
    ),
    SourceRepair(
        "rclpy/executors.py",
        re.compile(
            r"^(?P<next>            try:\n                return next\(self\._cb_iter\)\n)", re.MULTILINE
        ),
        "a signal before the wait is a shutdown, not an error.",
        r"\g<next>"
        """            except _rclpy.RCLError:
                {mark}
                if self._context.ok():
                    raise
                raise ExternalShutdownException() from None
""",
    ),
    SourceRepair(
        "rclpy/action/client.py",
        re.compile(
            # A client that has a lock already sends in a block of it: the second line is indented further.
            r"^(?P<init>        self\._is_ready = False\n)"
            r"(?P<rest>.*^        sequence_number = self\._client_handle\.send_goal_request\(.*)\Z",
            re.MULTILINE | re.DOTALL,
        ),
        "no answer is taken before the number of its request is noted.",
        r"\g<init>        self._sending_or_taking = threading.RLock()\n\g<rest>\n\n"
        """{mark}
import functools


def _one_at_a_time(method):
    @functools.wraps(method)
    def locked(self, *args, **kwargs):
        # Reentrant, because a signal handler may send a goal while this thread is sending one.
        with self._sending_or_taking:
            return method(self, *args, **kwargs)

    return locked


for _name in ('send_goal_async', '_cancel_goal_async', '_get_result_async', 'take_data'):
    setattr(ActionClient, _name, _one_at_a_time(getattr(ActionClient, _name)))
""",
    ),
)


def repair_sources(site_packages: Path) -> list[Path]:
    """Make the changes that existing modules do not have yet, each in one step, and return these modules."""
    changed = []
    for module in SOURCE_REPAIRS:
        path = site_packages / module.file
        if not path.is_file():
            continue
        text = path.read_text(encoding="utf-8")
        new = module.repaired(text)
        if new != text:
            _replace_content(path, new.encode())
            changed.append(path)
    return list(dict.fromkeys(changed))


def repaired_fast_dds(library: bytes) -> bytes:
    """Return the library with both waits limited; unchanged unless each is found exactly once."""
    if len(_BOTH.findall(library)) != 1:
        return library
    return _BOTH.sub(lambda both: YEARS_68.join(both.groups()), library)


def repair_fast_dds(prefix: Path) -> list[Path]:
    """Repair the libraries of the wheels that are not repaired yet, each in one step, and return them.

    Args:
        prefix: The environment, such as ``.venv``.
    """
    changed = []
    for path in sorted((prefix / "lib").glob("libfastrtps.so*")):
        before = path.read_bytes()
        after = repaired_fast_dds(before)
        if after != before:
            _replace_content(path, after)
            changed.append(path)
    return changed


def _replace_content(path: Path, content: bytes) -> None:
    """Give a file another content; an interruption leaves it with the old one or the new one, and its mode stays."""
    beside = path.with_name(f"{path.name}.new")
    beside.write_bytes(content)
    beside.chmod(path.stat().st_mode)
    beside.replace(path)


def main() -> int:
    """Repair the wheels of the environment whose Python runs this."""
    try:
        changed = repair_cmake(Path(sys.prefix), HeaderFolders.here())
    except RepairError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(f"{len(changed)} CMake files repaired")
    return 0


if __name__ == "__main__":
    sys.exit(main())
