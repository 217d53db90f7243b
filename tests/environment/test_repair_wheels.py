"""The repair of the wheels' CMake files."""

from __future__ import annotations

import stat
import sys
from pathlib import Path

import pytest

from environment.repair_wheels import HeaderFolders, RepairError, repair, repaired

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
    text = repaired(EXPORT.format(tag=tag, version=version, core=core), HEADERS)
    assert REPAIRED in text.splitlines()
    assert "/opt/python" not in text


def test_nothing_else_of_the_text_changes() -> None:
    text = EXPORT.format(tag="cp311", version="3.11", core="_core")
    before, after = text.splitlines(), repaired(text, HEADERS).splitlines()
    assert [line for line in before if "/opt/python" not in line] == [
        line for line in after if line != REPAIRED
    ]


def test_an_unknown_folder_of_the_build_machine_is_an_error_that_names_file_and_folder(
    tmp_path: Path,
) -> None:
    path = wheel_file(tmp_path, "odd_msgs", 'set(X "/opt/python/cp311-cp311/lib/libpython3.11.so")\n')
    with pytest.raises(RepairError, match=r"libpython3\.11\.so") as caught:
        repair(tmp_path, HEADERS)
    assert str(path) in str(caught.value)


def test_only_the_files_that_need_it_are_changed_and_a_second_run_changes_none(tmp_path: Path) -> None:
    broken = wheel_file(tmp_path, "std_msgs", EXPORT.format(tag="cp311", version="3.11", core="_core"))
    sound = wheel_file(tmp_path, "rcl", "set(rcl_FOUND TRUE)\n")
    before = sound.stat().st_mtime_ns
    assert repair(tmp_path, HEADERS) == [broken]
    assert REPAIRED in broken.read_text().splitlines()
    assert repair(tmp_path, HEADERS) == []
    assert sound.stat().st_mtime_ns == before


def test_mode_and_foreign_bytes_of_a_file_survive(tmp_path: Path) -> None:
    path = wheel_file(tmp_path, "std_msgs", EXPORT.format(tag="cp313", version="3.13", core="_core"))
    path.write_bytes(b"# caf\xe9 in Latin-1\n" + path.read_bytes())
    path.chmod(0o640)
    repair(tmp_path, HEADERS)
    assert path.read_bytes().startswith(b"# caf\xe9 in Latin-1\n")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(path.parent.iterdir()) == [path]


def test_a_symbolic_link_in_a_path_with_a_backslash_is_no_pattern() -> None:
    headers = HeaderFolders(python=Path(r"/usr/a\1b"), numpy=Path(r"/usr/n\g<0>"))
    text = repaired(EXPORT.format(tag="cp311", version="3.11", core="_core"), headers)
    assert r'"/usr/a\1b;/usr/n\g<0>"' in text


def test_this_environment_is_repaired() -> None:
    headers = HeaderFolders.here()
    assert headers.python.is_dir()
    assert repair(Path(sys.prefix), headers) == []
