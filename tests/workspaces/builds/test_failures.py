"""The line that matters, out of logs as the tools write them."""

from __future__ import annotations

from pathlib import Path

import pytest

from autograder.workspaces.builds.colcon_build import Build, failed_build

LOGS = {
    "compiler": (
        "[ 50%] Building CXX object x.o\n/home/me/ros2_ws/src/arm/src/arm.cpp:7:3: error: 'nod' was not declared in "
        "this scope\nmake[2]: *** [x.o] Error 1\n",
        "src/arm.cpp:7: 'nod' was not declared in this scope",
    ),
    "unknown command": (
        "CMake Error at CMakeLists.txt:6 (rosidl_generate_interfaces):\n  Unknown CMake command\n  "
        '"rosidl_generate_interfaces".\n\n\n-- Configuring incomplete, errors occurred!\n',
        'CMakeLists.txt:6: Unknown CMake command "rosidl_generate_interfaces".',
    ),
    "called by the package": (
        "CMake Error at /opt/ros/cmake/rosidl_generate_interfaces.cmake:95 (message):\n"
        "  rosidl_generate_interfaces() the passed file 'AddTwoInts.srv' doesn't exist\n"
        "  relative to the CMAKE_CURRENT_SOURCE_DIR '/ws/src/arm'\n"
        "Call Stack (most recent call first):\n  CMakeLists.txt:6 (rosidl_generate_interfaces)\n\n\n"
        "-- Configuring incomplete, errors occurred!\n",
        "CMakeLists.txt:6: rosidl_generate_interfaces() the passed file 'AddTwoInts.srv' doesn't exist relative to the "
        "CMAKE_CURRENT_SOURCE_DIR '/ws/src/arm'",
    ),
    "two streams at once": (
        "CMake Error at /opt/ros/cmake/rosidl_generate_interfaces.cmake:95 (message):\n-- Found python_cmake_module\n"
        "  rosidl_generate_interfaces() the passed file 'AddTwoInts.srv' doesn't exist\n"
        "Call Stack (most recent call first):\n-- Configuring incomplete, errors occurred!\n"
        "  CMakeLists.txt:6 (rosidl_generate_interfaces)\n\n\n",
        "CMakeLists.txt:6: rosidl_generate_interfaces() the passed file 'AddTwoInts.srv' doesn't exist",
    ),
    "CMake's last words": ("no such thing\n-- Configuring incomplete, errors occurred!\n", "no such thing"),
    "generator": (
        'Traceback (most recent call last):\n  File "<string>", line 1, in <module>\n'
        "rosidl_adapter.parser.InvalidFieldDefinition: 'a' has no type\n"
        "CMake Error at /opt/ros/cmake/rosidl_adapt_interfaces.cmake:59 (message):\n"
        "  execute_process(python3 ...)\n  returned error code 1:\n\nCall Stack (most recent call first):\n",
        "<string>:1: rosidl_adapter.parser.InvalidFieldDefinition: 'a' has no type",
    ),
    "setuptools": (
        "warning: build_py: byte-compiling is disabled\nerror: can't copy 'resource/x': doesn't exist\n",
        "can't copy 'resource/x': doesn't exist",
    ),
    "setup.py": (
        '  File "/venv/lib/python3.11/site-packages/setuptools/core.py", line 268, in run_setup\n    exec(code, g)\n'
        '  File "<string>", line 7\n    version=\nSyntaxError: invalid syntax\n'
        "subprocess.CalledProcessError: Command '[...]' returned non-zero exit status 1.\n",
        "setup.py:7: SyntaxError: invalid syntax",
    ),
    "anything else": (
        "all is well\n\nno space left on device\nmake: *** stopped\n",
        "no space left on device",
    ),
    "nothing": ("", ""),
}


@pytest.mark.parametrize("name", LOGS)
def test_the_line_that_matters(name: str) -> None:
    log, expected = LOGS[name]
    assert failed_build(Build(Path(), ok=False), log).line == expected
