"""Small workspaces, written by the tests that need them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.workspaces.packages import Package, find_packages
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE_XML = cases(__file__, "PACKAGE_XML")
SETUP_PY = cases(__file__, "SETUP_PY")


def python_package(src: Path, name: str = "tiny_pkg") -> Path:
    """A package with one program, which prints a line."""
    folder = src / name
    (folder / name).mkdir(parents=True)
    (folder / "resource").mkdir()
    (folder / "resource" / name).touch()
    (folder / name / "__init__.py").touch()
    (folder / name / "hello.py").write_text("def main():\n    print('hello from the workspace')\n")
    (folder / "package.xml").write_text(PACKAGE_XML.format(name=name))
    (folder / "setup.py").write_text(SETUP_PY.format(name=name))
    script = f"$base/lib/{name}"
    (folder / "setup.cfg").write_text(
        f"[develop]\nscript_dir={script}\n[install]\ninstall_scripts={script}\n"
    )
    return folder


CMAKE = cases(__file__, "CMAKE")
INTERFACE_PACKAGE_XML = cases(__file__, "INTERFACE_PACKAGE_XML")
DEFINITION = "int64 a\nint64 b\n---\nint64 sum\n"


def interface_package(folder: Path, comment: str = "") -> Path:
    """A package that makes one service type; the comment is in all of its texts."""
    (folder / "srv").mkdir(parents=True)
    (folder / "srv" / "AddTwoInts.srv").write_text(f"{comment}{DEFINITION}")
    (folder / "CMakeLists.txt").write_text(f"{comment}{CMAKE}")
    (folder / "package.xml").write_text(INTERFACE_PACKAGE_XML)
    (folder / "LICENSE").write_text(comment)
    return folder


def packages_in(src: Path) -> list[Package]:
    """The packages below a folder, all of which can be used."""
    packages, unusable = find_packages(src)
    assert not unusable
    return packages
