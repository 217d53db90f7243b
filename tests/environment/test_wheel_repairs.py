"""The repairs of the wheels: CMake files, imports, an executor with several threads, action clients, Fast DDS."""

from __future__ import annotations

import ctypes
import json
import os
import stat
import subprocess
import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

import pytest

from environment.wheel_repairs import (
    FOR_EVER,
    SOURCE_REPAIRS,
    YEARS_68,
    HeaderFolders,
    RepairError,
    repair_cmake,
    repair_fast_dds,
    repair_sources,
    repaired_cmake,
    repaired_fast_dds,
)

if TYPE_CHECKING:
    from collections.abc import Callable

EXPORT = """\
add_library(std_msgs::std_msgs__rosidl_generator_py SHARED IMPORTED)

set_target_properties(std_msgs::std_msgs__rosidl_generator_py PROPERTIES
  INTERFACE_INCLUDE_DIRECTORIES "/opt/python/{tag}-{tag}/include/python{version};\
/opt/python/{tag}-{tag}/lib/python{version}/site-packages/numpy/{core}/include"
  INTERFACE_LINK_LIBRARIES "std_msgs::std_msgs__rosidl_generator_c"
)
"""
REPAIRED = '  INTERFACE_INCLUDE_DIRECTORIES "/usr/include/python3.12;/env/numpy/_core/include"'
HEADERS = HeaderFolders(python=Path("/usr/include/python3.12"), numpy=Path("/env/numpy/_core/include"))

GENERATOR = """\
import logging

from .import_type_support_impl import import_type_support

try:
    from .generate_py_impl import generate_py
    assert generate_py
except ImportError:
    logging.debug('Failed to import')
"""
MESSAGE = """\
import builtins  # noqa: E402, I100

# Member 'client_gid'
import numpy  # noqa: E402, I100

class ServiceEventInfo:
    client_gid = lambda self: numpy.zeros(16, dtype=numpy.uint8)
"""
GRAMMARS = "from .syntax_helpers import *\n"
PARAMETERS = """\
class Node:
    def _set_parameters_atomically(self, parameter_list):
        modified_parameter_list = self._call_pre_set_parameters_callback(parameter_list)
        return modified_parameter_list
"""
EXECUTOR = """\
class Executor:
    def wait_for_ready_callbacks(self):
        while True:
            try:
                return next(self._cb_iter)
            except StopIteration:
                self._cb_iter = None


class MultiThreadedExecutor:
    def __init__(self, pool):
        self._futures = []
        self._executor = pool

    def spin_once(self, handler):
        if handler:
            self._executor.submit(handler)
            self._futures.append(handler)
"""
CLIENT = """\
import threading


class ActionClient:
    def __init__(self):
        self._is_ready = False

    def send_goal_async(self):
        sequence_number = self._client_handle.send_goal_request(request)

    def _cancel_goal_async(self):
        pass

    def _get_result_async(self):
        pass

    def take_data(self):
        return self._sending_or_taking.acquire(blocking=False)
"""
MENDED_CLIENT = CLIENT.replace(
    "        sequence_number", "        with self._lock:\n            sequence_number"
)
TEXTS = (GENERATOR, MESSAGE, GRAMMARS, PARAMETERS, EXECUTOR, EXECUTOR, CLIENT)

INSTALLED = Path(sys.prefix) / "lib/libfastrtps.so"
SET_LISTENER = "_ZN8eprosima7fastdds3dds17DomainParticipant12set_listenerEPNS1_25DomainParticipantListenerE"
IMPLEMENTATION, MUTEX, CONDITION, CALLBACKS = 0x48, 0x510, 0x538, 0xCE8
"""Where Fast DDS 2.14.5 keeps them, in bytes: the first in a DomainParticipant, the others in what it points at."""
CODE = b"\x90\x48\xba%b\xe9\x01\x02\x03\x04\x90\x48\xb9%b\xe9\x0a\x0b\x0c\x0d\x90"
FOUND = CODE % (FOR_EVER, FOR_EVER)


def wheel_file(prefix: Path, package: str, text: str) -> Path:
    """Write a CMake file where a wheel puts it."""
    path = prefix / "share" / package / "cmake" / f"export_{package}__rosidl_generator_pyExport.cmake"
    path.parent.mkdir(parents=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("tag", "version", "core"),
    [("cp311", "3.11", "_core"), ("cp314", "3.14", "_core"), ("cp310", "3.10", "core")],
)
def test_both_header_folders_are_pointed_at_this_interpreter(tag: str, version: str, core: str) -> None:
    text = repaired_cmake(EXPORT.format(tag=tag, version=version, core=core), HEADERS)
    assert REPAIRED in text.splitlines()
    assert "/opt/python" not in text


def test_nothing_else_of_the_text_changes() -> None:
    text = EXPORT.format(tag="cp311", version="3.11", core="_core")
    before, after = text.splitlines(), repaired_cmake(text, HEADERS).splitlines()
    assert [line for line in before if "/opt/python" not in line] == [
        line for line in after if line != REPAIRED
    ]


def test_an_unknown_folder_of_the_build_machine_is_an_error_that_names_file_and_folder(
    tmp_path: Path,
) -> None:
    path = wheel_file(tmp_path, "odd_msgs", 'set(X "/opt/python/cp311-cp311/lib/libpython3.11.so")\n')
    with pytest.raises(RepairError, match=r"libpython3\.11\.so") as caught:
        repair_cmake(tmp_path, HEADERS)
    assert str(path) in str(caught.value)


def test_only_the_files_that_need_it_are_changed_and_a_second_run_changes_none(tmp_path: Path) -> None:
    broken = wheel_file(tmp_path, "std_msgs", EXPORT.format(tag="cp311", version="3.11", core="_core"))
    sound = wheel_file(tmp_path, "rcl", "set(rcl_FOUND TRUE)\n")
    before = sound.stat().st_mtime_ns
    assert repair_cmake(tmp_path, HEADERS) == [broken]
    assert REPAIRED in broken.read_text().splitlines()
    assert repair_cmake(tmp_path, HEADERS) == []
    assert sound.stat().st_mtime_ns == before


def test_mode_and_foreign_bytes_of_a_file_survive(tmp_path: Path) -> None:
    path = wheel_file(tmp_path, "std_msgs", EXPORT.format(tag="cp313", version="3.13", core="_core"))
    path.write_bytes(b"# caf\xe9 in Latin-1\n" + path.read_bytes())
    path.chmod(0o640)
    repair_cmake(tmp_path, HEADERS)
    assert path.read_bytes().startswith(b"# caf\xe9 in Latin-1\n")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(path.parent.iterdir()) == [path]


def test_a_symbolic_link_in_a_path_with_a_backslash_is_no_pattern() -> None:
    headers = HeaderFolders(python=Path(r"/usr/a\1b"), numpy=Path(r"/usr/n\g<0>"))
    text = repaired_cmake(EXPORT.format(tag="cp311", version="3.11", core="_core"), headers)
    assert r'"/usr/a\1b;/usr/n\g<0>"' in text


def test_this_environment_is_repaired_cmake() -> None:
    headers = HeaderFolders.here()
    assert headers.python.is_dir()
    assert repair_cmake(Path(sys.prefix), headers) == []


@pytest.fixture
def wheels(tmp_path: Path) -> Path:
    for module, text in zip(SOURCE_REPAIRS, TEXTS, strict=True):
        file = tmp_path / module.file
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        file.chmod(0o644)
    (tmp_path / "rosidl_generator_py/import_type_support_impl.py").write_text("import_type_support = 1\n")
    (tmp_path / "rosidl_generator_py/generate_py_impl.py").write_text(
        "import json\ngenerate_py = json.dumps\n"
    )
    (tmp_path / "rfc3987_syntax/syntax_helpers.py").write_text(
        "def is_valid_syntax(term, value):\n    return value == term\nsyntax_parser = 'made'\n"
    )
    (tmp_path / "service_msgs/msg/__init__.py").write_text("")
    (tmp_path / "service_msgs/__init__.py").write_text("")
    return tmp_path


def run(program: str, first: Path | None = None) -> Any:
    """What a program says with ``print(json.dumps(…))``, in a process of this environment."""
    folders = {"PYTHONPATH": str(first)} if first else {}
    done = subprocess.run(
        [sys.executable, "-c", f"import json as said\n{program}"],
        env={**os.environ, **folders},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def test_what_is_not_needed_is_imported_where_it_is_used(wheels: Path) -> None:
    changed = ["__init__.py", "_service_event_info.py", "__init__.py", "node.py", "executors.py", "client.py"]
    assert [path.name for path in repair_sources(wheels)] == changed
    program = """
import sys
import rosidl_generator_py
from service_msgs.msg._service_event_info import ServiceEventInfo
before = [name in sys.modules for name in ("rosidl_generator_py.generate_py_impl", "numpy")]
from rosidl_generator_py import generate_py
made = ServiceEventInfo().client_gid()
missing = hasattr(rosidl_generator_py, "generate_cpp")
print(said.dumps([before, generate_py([1]), len(made), missing]))
"""
    assert run(program, wheels) == [[False, False], "[1]", 16, False]


def test_sources_are_repaired_once(wheels: Path) -> None:
    changed = repair_sources(wheels)
    texts = [path.read_bytes() for path in changed]
    assert repair_sources(wheels) == []
    assert [path.read_bytes() for path in changed] == texts
    assert {path.stat().st_mode & 0o777 for path in changed} == {0o644}
    assert not list(wheels.rglob("*.new"))


class Pool(ThreadPoolExecutor):
    """A pool with one thread, which keeps what it was given."""

    def __init__(self) -> None:
        super().__init__(1)
        self.given: list[Callable[[], object]] = []

    def submit(self, work: Callable[[], Any], /, *_: object, **__: object) -> Future[Any]:
        self.given.append(work)
        return super().submit(work)


def test_a_callback_that_waits_for_a_thread_is_not_queued_again(wheels: Path) -> None:
    file = wheels / "rclpy/executors.py"
    repair_sources(wheels)
    module: dict[str, Any] = {}
    exec(compile(file.read_text(), file, "exec"), module)
    with Pool() as pool:
        executor, free = module["MultiThreadedExecutor"](pool), threading.Event()
        pool.submit(free.wait)
        callback, awaits = mock.Mock(_turn=None), mock.Mock(_turn=None)
        callback.done.return_value = awaits.done.return_value = False
        for _ in range(3):
            executor.spin_once(callback)
            executor.spin_once(awaits)
        assert pool.given == [free.wait, callback, awaits]
        free.set()
        pool.submit(int).result()
        callback.done.return_value = True
        executor.spin_once(awaits)
        # What awaits something has returned, and is not done: it goes on where the executor runs it again.
        assert pool.given[4:] == [awaits]
        assert executor._futures == [callback, awaits]
        assert vars(executor).keys() == {"_executor", "_futures"}


def test_a_module_of_which_an_earlier_set_up_made_one_change_gets_the_other(wheels: Path) -> None:
    repair_sources(wheels)
    file = wheels / "rclpy/executors.py"
    both = file.read_text()
    one_change = next(repair for repair in SOURCE_REPAIRS if "queued again" in repair.change)
    file.write_text(one_change.repaired(EXECUTOR))
    assert file.read_text() not in (EXECUTOR, both)
    assert repair_sources(wheels) == [file]
    assert file.read_text() == both


def test_a_signal_just_before_the_executor_waits_is_a_shutdown() -> None:
    """`rclpy.shutdown` does here what a signal's handler does between the look at the context and the wait."""
    program = """
import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
ends = []
for kind, seconds in ((SingleThreadedExecutor, None), (SingleThreadedExecutor, 0.1), (MultiThreadedExecutor, None)):
    rclpy.init()
    executor = kind()
    executor.add_node(rclpy.create_node("signalled"))
    rclpy.shutdown()
    try:
        executor.spin_once(seconds)
        ends.append("returned")
    except ExternalShutdownException:
        ends.append("shut down")
print(said.dumps(ends))
"""
    # An executor with several threads takes the exception for its end, as rclpy has it.
    assert run(program) == ["shut down", "shut down", "returned"]


def test_an_action_client_takes_no_answer_while_it_sends(wheels: Path) -> None:
    """:mod:`tests.environment.test_action_answers` forces the order with the real one."""
    client = wheels / "rclpy/action/client.py"
    repair_sources(wheels)
    module: dict[str, Any] = {}
    exec(compile(client.read_text(), client, "exec"), module)
    taken = []
    one = module["ActionClient"]()
    with one._sending_or_taking:
        other = threading.Thread(target=lambda: taken.append(one.take_data()))
        other.start()
        assert not taken
    other.join()
    assert taken == [True]


def test_an_action_client_with_a_lock_of_its_own_is_left_alone(tmp_path: Path) -> None:
    client = tmp_path / "rclpy/action/client.py"
    client.parent.mkdir(parents=True)
    client.write_text(MENDED_CLIENT)
    assert repair_sources(tmp_path) == []


def test_a_file_that_looks_otherwise_and_one_that_is_not_there_are_left_alone(tmp_path: Path) -> None:
    file = tmp_path / SOURCE_REPAIRS[0].file
    file.parent.mkdir()
    file.write_text("from .import_type_support_impl import import_type_support\n", encoding="utf-8")
    assert repair_sources(tmp_path) == []
    assert file.read_text(encoding="utf-8") == "from .import_type_support_impl import import_type_support\n"


def test_grammars_of_addresses_are_compiled_for_who_asks_for_one(wheels: Path) -> None:
    repair_sources(wheels)
    program = """
import sys
from rfc3987_syntax import is_valid_syntax
before = "rfc3987_syntax.syntax_helpers" in sys.modules
import rfc3987_syntax
told = [is_valid_syntax("iri", "iri"), rfc3987_syntax.syntax_parser, hasattr(rfc3987_syntax, "other")]
print(said.dumps([before, *told]))
"""
    assert run(program, wheels) == [False, True, "made", False]


def test_who_reads_a_notebook_compiles_no_grammar() -> None:
    program = "import sys, nbformat; print(said.dumps('rfc3987_syntax.syntax_helpers' in sys.modules))"
    assert run(program) is False


@pytest.mark.ros
def test_a_node_of_this_environment_imports_neither_of_them() -> None:
    if not (Path(sys.prefix) / "share/rclpy").is_dir():
        pytest.skip("a ROS that was sourced is as it is")
    program = """
import sys
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("light")
node.create_publisher(String, "chatter", 10)
names = [name for name in ("numpy", "lark", "rosidl_generator_py.generate_py_impl") if name in sys.modules]
node.destroy_node()
rclpy.shutdown()
from service_msgs.msg import ServiceEventInfo
from rosidl_generator_py import generate_py
print(said.dumps([names, len(ServiceEventInfo().client_gid), callable(generate_py)]))
"""
    assert run(program) == [[], 16, True]


def test_both_waits_get_a_deadline_and_nothing_else_changes() -> None:
    assert (
        repaired_fast_dds(b"before" + FOUND + b"after") == b"before" + CODE % (YEARS_68, YEARS_68) + b"after"
    )


@pytest.mark.parametrize(
    "library",
    [b"", FOR_EVER, FOUND + FOUND, CODE % (YEARS_68, YEARS_68)],
    ids=["none", "else", "two", "done"],
)
def test_a_library_that_does_not_look_as_expected_is_left_alone(library: bytes) -> None:
    assert repaired_fast_dds(library) == library


def test_each_copy_is_repaired_once_and_stays_executable(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    copies = [tmp_path / "lib" / name for name in ("libfastrtps.so", "libfastrtps.so.2.14")]
    for copy in copies:
        copy.write_bytes(FOUND)
        copy.chmod(0o755)
    assert repair_fast_dds(tmp_path) == copies
    assert repair_fast_dds(tmp_path) == []
    assert {copy.stat().st_mode & 0o777 for copy in copies} == {0o755}
    assert repair_fast_dds(tmp_path / "nothing") == []


@pytest.mark.skipif(not INSTALLED.exists(), reason="a ROS that was sourced")
def test_the_installed_one_waits_until_the_callback_has_ended() -> None:
    """The library's own code on a participant that is only memory, in which one callback is said to be running."""
    system = ctypes.CDLL(None)
    set_listener = ctypes.CDLL(str(INSTALLED))[SET_LISTENER]
    set_listener.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    participant, inside = ctypes.create_string_buffer(0x1000), ctypes.create_string_buffer(0x1000)
    address = ctypes.addressof(inside)
    ctypes.c_void_p.from_buffer(participant, IMPLEMENTATION).value = address
    callbacks = ctypes.c_int.from_buffer(inside, CALLBACKS)
    mutex, condition = ctypes.c_void_p(address + MUTEX), ctypes.c_void_p(address + CONDITION)
    callbacks.value = 1
    returned: list[int] = []
    waiting = threading.Thread(
        target=lambda: returned.append(set_listener(ctypes.addressof(participant), None)), daemon=True
    )
    waiting.start()
    for _ in range(2000):  # without the repair it never waits, and this ends some time
        if _has_waited(inside):
            break
        waiting.join(0.01)
    assert _has_waited(inside)
    # Whoever waits has released the mutex, which the callback takes to say that it has ended.
    system.pthread_mutex_lock(mutex)
    callbacks.value = 0
    system.pthread_cond_broadcast(condition)
    system.pthread_mutex_unlock(mutex)
    waiting.join()
    assert returned == [0]


def _has_waited(inside: ctypes.Array[ctypes.c_char]) -> bool:
    """glibc counts in a condition variable who has begun to wait, in steps of two (nptl/pthread_cond_wait.c)."""
    return ctypes.c_uint64.from_buffer(inside, CONDITION).value >= 2
