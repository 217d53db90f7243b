"""Small workspaces, written by the tests that need them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE_XML = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>For a test</description>
  <maintainer email="student@example.com">student</maintainer>
  <license>MIT</license>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
SETUP_PY = """from setuptools import setup

setup(
    name={name!r},
    version='0.0.0',
    packages=[{name!r}],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/{name}']),
        ('share/{name}', ['package.xml']),
    ],
    entry_points={{'console_scripts': ['hello = {name}.hello:main']}},
)
"""


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
