"""What a node's imports leave out, and that it is there for who asks for it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from environment.lighter_imports import MODULES, make_lighter

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


@pytest.fixture
def wheels(tmp_path: Path) -> Path:
    for module, text in zip(MODULES, (GENERATOR, MESSAGE, GRAMMARS), strict=True):
        file = tmp_path / module.file
        file.parent.mkdir(parents=True)
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
    changed = ["__init__.py", "_service_event_info.py", "__init__.py"]
    assert [path.name for path in make_lighter(wheels)] == changed
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


def test_a_second_run_changes_nothing(wheels: Path) -> None:
    changed = make_lighter(wheels)
    texts = [path.read_bytes() for path in changed]
    assert make_lighter(wheels) == []
    assert [path.read_bytes() for path in changed] == texts
    assert {path.stat().st_mode & 0o777 for path in changed} == {0o644}
    assert not list(wheels.rglob("*.new"))


def test_a_file_that_looks_otherwise_and_one_that_is_not_there_are_left_alone(tmp_path: Path) -> None:
    file = tmp_path / MODULES[0].file
    file.parent.mkdir()
    file.write_text("from .import_type_support_impl import import_type_support\n", encoding="utf-8")
    assert make_lighter(tmp_path) == []
    assert file.read_text(encoding="utf-8") == "from .import_type_support_impl import import_type_support\n"


def test_grammars_of_addresses_are_compiled_for_who_asks_for_one(wheels: Path) -> None:
    make_lighter(wheels)
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
