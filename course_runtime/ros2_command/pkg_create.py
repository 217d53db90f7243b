"""`ros2 pkg create`."""

from __future__ import annotations

import getpass
import os
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from course_runtime.ros2_command import pkg_templates as templates
from course_runtime.ros2_command.commands import Outcome, Verb

if TYPE_CHECKING:
    import argparse

_LICENSES = Path(__file__).with_name("licenses")


def known_licenses() -> list[str]:
    """Return the SPDX names of the licenses whose text can be written into a package."""
    return sorted(path.stem for path in _LICENSES.glob("*.txt"))


def _user_name() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "user"


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("package_name", help="The package name")
    parser.add_argument(
        "--package-format",
        "--package_format",
        type=int,
        default=3,
        choices=[2, 3],
        help="The package.xml format.",
    )
    parser.add_argument(
        "--description", default="TODO: Package description", help="The description given in the package.xml"
    )
    parser.add_argument(
        "--license",
        default="TODO: License declaration",
        help="The license attached to this package; this can be an arbitrary string, but a LICENSE file will "
        "only be generated if it is one of the supported licenses (pass '?' to get a list)",
    )
    parser.add_argument(
        "--destination-directory", default=os.curdir, help="Directory where to create the package directory"
    )
    parser.add_argument(
        "--build-type",
        default="ament_cmake",
        choices=["ament_cmake", "ament_python"],
        help="The build type to process the package with",
    )
    parser.add_argument("--dependencies", nargs="+", default=[], help="list of dependencies")
    parser.add_argument("--maintainer-email", help="email address of the maintainer of this package")
    parser.add_argument(
        "--maintainer-name", default=_user_name(), help="name of the maintainer of this package"
    )
    parser.add_argument("--node-name", help="name of the empty executable")


def _email(args: argparse.Namespace) -> str:
    """Return the maintainer's address: the given one, or git's, or else one that has to be replaced."""
    if args.maintainer_email:
        return str(args.maintainer_email)
    git = shutil.which("git")
    if git:
        answer = subprocess.run([git, "config", "user.email"], capture_output=True, text=True, check=False)
        if answer.stdout.strip():
            return answer.stdout.strip()
    return f"{args.maintainer_name}@todo.todo"


def _tell(package: templates.Package, destination: str) -> None:
    print("going to create a new package")
    print("package name:", package.name)
    print("destination directory:", os.path.abspath(destination))  # noqa: PTH100 (does not follow links)
    print("package format:", package.package_format)
    print("version: 0.0.0")
    print("description:", package.description)
    print("maintainer:", [f"{package.maintainer} <{package.email}>"])
    print("licenses:", [package.license])
    print("build type:", package.build_type)
    print("dependencies:", list(package.dependencies))
    if package.node_name:
        print("node_name:", package.node_name)


def _folder(path: str) -> str:
    print("creating folder", path)
    Path(path).mkdir(parents=True, exist_ok=True)
    return path


def _file(folder: str, name: str, text: str) -> None:
    path = os.path.join(folder, name)  # noqa: PTH118 (keeps the leading ./ that is printed)
    print("creating", path)
    Path(path).write_text(text, encoding="utf-8")


def _write_python(package: templates.Package, top: str) -> None:
    print("creating source folder")
    source = _folder(f"{top}/{package.name}")
    _file(top, "setup.py", templates.setup_py(package))
    _file(top, "setup.cfg", templates.setup_cfg(package))
    _file(_folder(f"{top}/resource"), package.name, "")
    _file(source, "__init__.py", "")
    tests = _folder(f"{top}/test")
    for linter in ("copyright", "flake8", "pep257"):
        _file(tests, f"test_{linter}.py", templates.linter_test(linter))
    if package.node_name:
        _file(source, f"{package.node_name}.py", templates.python_node(package))


def _write_cmake(package: templates.Package, top: str) -> None:
    print("creating source and include folder")
    source = _folder(f"{top}/src")
    _folder(f"{top}/include/{package.name}")
    _file(top, "CMakeLists.txt", templates.cmake_lists(package))
    if package.node_name:
        _file(source, f"{package.node_name}.cpp", templates.cpp_node(package))


def _write_license(name: str, top: str) -> None:
    if name in known_licenses():
        shutil.copyfile(_LICENSES / f"{name}.txt", Path(top, "LICENSE"))
        return
    names = "\n".join(known_licenses())
    print(
        f"\n[WARNING]: Unknown license '{name}'.  This has been set in the package.xml, but no LICENSE file "
        f"has been created.\nIt is recommended to use one of these license identifiers:\n{names}"
    )


def _create(args: argparse.Namespace) -> Outcome:
    if args.license == "?":
        print("Supported licenses:", *known_licenses(), sep="\n")
        return None
    name = args.package_name
    if name != Path(name).name or name in (".", ".."):
        return f"'{name}' is not a package name: give the folder with --destination-directory"
    if args.build_type == "ament_python" and name == "test":
        # The folder of the source and the folder of the tests would be the same.
        return (
            "Aborted since 'ament_python' packages can't be named 'test'. "
            "Please choose a different package name."
        )
    package = templates.Package(
        name=name,
        build_type=args.build_type,
        package_format=args.package_format,
        description=args.description,
        license=args.license,
        maintainer=args.maintainer_name,
        email=_email(args),
        dependencies=tuple(args.dependencies),
        node_name=args.node_name,
    )
    top = f"{args.destination_directory.rstrip('/') or '/'}/{name}"
    if Path(top).exists():
        return (
            f"\nAborted!\nThe directory already exists: {top}\nEither remove the directory or choose a "
            "different destination directory or package name"
        )
    _tell(package, args.destination_directory)
    try:
        _folder(top)
        _file(top, "package.xml", templates.package_xml(package))
        (_write_python if package.build_type == "ament_python" else _write_cmake)(package, top)
        _write_license(package.license, top)
    except OSError as error:
        shutil.rmtree(top, ignore_errors=True)
        return f"\nAborted!\n{top} cannot be written, and nothing of it is left: {error.strerror}"
    return None


VERBS = {"create": Verb(_arguments, _create)}
