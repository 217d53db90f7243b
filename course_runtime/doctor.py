"""Say what the course needs is there, and what is missing: ``python -m course_runtime.doctor``.

Each probe examines one group of needs and returns Findings; `PROBES` lists the probes in order. A probe never raises
an exception: if it cannot find something out, this is a finding, too.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from course_runtime import jupyter_files, loopback, ros_flavour, system_packages
from course_runtime.installation import COMMAND, IS_CLONE, installing
from course_runtime.place import Place, may_write, owner
from course_runtime.python_child import INTERPRETER, PythonChild, python_child
from course_runtime.ros_report import INTERFACE_FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable

ROOT = Path(__file__).resolve().parent.parent
PREFIX = ROOT / ".venv"
SET_UP = "Type: ./course setup"

# Fast DDS moves messages between processes through /dev/shm. A participant takes about half a megabyte per
# transport; a container's default of 64 MB is enough for a class of one.
_SHM_NEEDED = 64_000_000
# The free disk space for class directories, notebooks with pictures, and logs, in bytes.
_DISK_NEEDED = 500_000_000
# Time limit in seconds for a program that only prints its version.
_SHORT = 20.0

# ok: it exists and works. missing: the course needs it. optional: it is missing, but only a part of the course needs
# it. unchecked: this could not be found out, because something else is missing.
State = Literal["ok", "missing", "optional", "unchecked"]

_SIGN = {"ok": "ok", "missing": "MISSING", "optional": "optional", "unchecked": "not checked"}


@dataclass(frozen=True)
class Finding:
    """The result for one thing that the course needs or can use.

    Attributes:
        name: The name of the thing.
        state: Whether the thing exists and is needed.
        detail: The version, the path, or what is wrong.
        remedy: How to install it; empty if there is nothing to do.
    """

    name: str
    state: State
    detail: str
    remedy: str = ""


def exit_code(findings: Iterable[Finding]) -> int:
    """Return 0 if everything that the course needs exists, else 1."""
    return 1 if any(finding.state == "missing" for finding in findings) else 0


def as_text(findings: Iterable[Finding]) -> str:
    """Return the findings as lines for a terminal: state, name, detail, and then the remedy."""
    lines = []
    for finding in findings:
        lines.append(f"{_SIGN[finding.state]:<12} {finding.name}: {finding.detail}")
        if finding.remedy:
            lines.append(f"{'':<12}   {finding.remedy}")
    return "\n".join(lines)


def _output(program: list[str] | PythonChild) -> tuple[int, str]:
    """Run a command. Return exit code and output; the code is 127 if it could not be started or did not end in time."""
    child = program if isinstance(program, PythonChild) else PythonChild(program, dict(os.environ), None)
    try:
        done = subprocess.run(
            child.command,
            env=child.environment,
            cwd=child.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=_SHORT,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return 127, str(error)
    return done.returncode, done.stdout


def _first_line(text: str) -> str:
    return next((line.strip() for line in text.splitlines() if line.strip()), "")


def _last_line(text: str) -> str:
    return _first_line("\n".join(reversed(text.splitlines())))


def _again(extra: str = "") -> str:
    """Return the command that installs what a set-up installs.

    Args:
        extra: The extra of the wheel; empty for something that comes only with a sourced ROS.
    """
    if IS_CLONE:
        return f"Delete the folder .venv, then {SET_UP[0].lower()}{SET_UP[1:]}"
    return f"Type: {installing(extra)}" if extra else "It comes with a ROS 2 Jazzy that is sourced."


def python() -> list[Finding]:
    """Check the Python that runs this, and the environment of the course."""
    detail = f"{sys.version.split()[0]}, {INTERPRETER}"
    if not IS_CLONE:
        return [Finding("Python", "ok", detail)]
    if Path(sys.prefix) == PREFIX:
        warning = Place(ROOT, Path(INTERPRETER)).warning
        return [
            Finding("Python", "ok", detail),
            *([Finding("Folder", "optional", warning)] if warning else []),
        ]
    if PREFIX.exists():
        remedy = f"Run this with {PREFIX / 'bin' / 'python'}"
        return [Finding("Python", "missing", f"{detail} is not the course's own", remedy)]
    return [Finding("Python", "missing", f"{detail}; the course is not set up in {ROOT}", SET_UP)]


def ros() -> list[Finding]:
    """Check the ROS 2 that was set up, its middleware and the interface package."""
    recorded = ros_flavour.load(Path(sys.prefix))
    # Only the last line is read, because a library may have printed something before it.
    report = _parsed(_last_line(_output(python_child("-m", "course_runtime.ros_report"))[1]))
    found = [_ros(recorded, report), _middleware(report)]
    # The wheel does not contain the course's own interfaces.
    return [*found, _interfaces(report)] if IS_CLONE else found


def _parsed(line: str) -> dict[str, object]:
    try:
        report = json.loads(line)
    except ValueError:
        report = None
    return report if isinstance(report, dict) else {"rclpy_error": line or "Python ended without a word"}


def _ros(recorded: ros_flavour.Ros | None, report: dict[str, object]) -> Finding:
    if "rclpy_error" in report:
        source = recorded is not None and recorded.is_sourced
        remedy = "Is the ROS 2 that was sourced at set-up still there? " * source + _again("ros")
        return Finding("ROS 2", "missing", f"rclpy cannot be imported: {report['rclpy_error']}", remedy)
    if not IS_CLONE and report.get("prefix") == sys.prefix:
        return Finding("ROS 2", "ok", f"from wheels, rclpy {report.get('version')}")
    flavour = recorded.flavour if recorded else "sourced"
    where = {"wheels": "from wheels", "system": "of the system", "robostack": "of RoboStack"}.get(
        flavour, flavour
    )
    distro = os.environ.get("ROS_DISTRO", "of an unknown distribution").capitalize()
    return Finding(
        "ROS 2", "ok", f"{distro} {where}, rclpy {report.get('version')} in {report.get('prefix')}"
    )


def _middleware(report: dict[str, object]) -> Finding:
    if "rmw" not in report:
        return Finding("Middleware", "unchecked", "rclpy is missing")
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    return Finding("Middleware", "ok", f"{report['rmw']}, ROS_DOMAIN_ID {domain}")


def _interfaces(report: dict[str, object]) -> Finding:
    name = "my_robot_interfaces"
    if "fields" not in report:
        return Finding(name, "missing", str(report.get("interfaces_error", "rclpy is missing")), _again())
    if report["fields"] != INTERFACE_FIELDS:
        detail = f"another package of that name is in the way: its fields are {report['fields']}"
        return Finding(name, "missing", detail, "Type it in a terminal without a sourced workspace.")
    return Finding(name, "ok", "AddTwoInts and Fibonacci")


def talk() -> list[Finding]:
    """Check whether two processes can exchange a message over ROS."""
    name = "Two nodes talk"
    if _output(python_child("-c", "import rclpy"))[0] != 0:
        return [Finding(name, "unchecked", "rclpy is missing")]
    seconds = loopback.seconds_to_first_message()
    if seconds is None:
        detail = f"a listener heard nothing of a talker beside it for {loopback.LIMIT:.0f} s"
        remedy = (
            f"Try: ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST FASTDDS_BUILTIN_TRANSPORTS=UDPv4 {COMMAND} doctor"
        )
        return [Finding(name, "missing", detail, remedy)]
    return [
        Finding(name, "ok", f"the first message arrived {seconds:.1f} s after the start of both processes")
    ]


def build_tools() -> list[Finding]:
    """Check the programs that build packages."""
    found = []
    compilers = system_packages.find_compilers()
    if compilers:
        versions = [_first_line(_output([path, "--version"])[1]) for path in compilers]
        found.append(Finding("C and C++ compiler", "ok", ", ".join(dict.fromkeys(versions))))
    for row in system_packages.missing("setup"):
        remedy = system_packages.get_with([row], system_packages.Apt.here())
        found.append(Finding(row.title, "missing", f"needed {row.reason}", remedy))
    found.append(_program("CMake", "cmake", ["--version"]))
    colcon = shutil.which("colcon")
    colcon_version = _distribution("colcon-core")
    if colcon and colcon_version:
        found.append(Finding("colcon", "ok", f"colcon-core {colcon_version}, {colcon}"))
    else:
        found.append(Finding("colcon", "missing", "not found on the PATH", _again()))
    return found


def _program(title: str, name: str, arguments: list[str]) -> Finding:
    path = shutil.which(name)
    code, text = _output([path, *arguments]) if path else (127, "not found on the PATH")
    if code != 0:
        return Finding(title, "missing", _last_line(text), _again())
    return Finding(title, "ok", f"{_first_line(text)}, {path}")


def _distribution(name: str) -> str:
    """Return the version of an installed Python package, or an empty text."""
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def jupyter() -> list[Finding]:
    """Check JupyterLab, nbgrader and the kernel."""
    found = []
    for title, name in (("JupyterLab", "jupyterlab"), ("nbgrader", "nbgrader")):
        number = _distribution(name)
        found.append(
            Finding(title, "ok", number)
            if number
            else Finding(title, "missing", "not installed", _again("class"))
        )
    if not IS_CLONE:  # an installed wheel uses the user's own kernel
        return found
    spec = Path(sys.prefix) / "share/jupyter/kernels" / jupyter_files.KERNEL_NAME / "kernel.json"
    return [*found, kernel(spec)]


def kernel(spec: Path) -> Finding:
    """Check a kernelspec: it must start an existing Python, with the variables of a graded cell."""
    name = f"Kernel {jupyter_files.KERNEL_NAME}"
    try:
        content = json.loads(spec.read_text(encoding="utf-8"))
        program, variables = content["argv"][0], content.get("env", {})
    except (OSError, ValueError, LookupError, TypeError) as error:
        return Finding(name, "missing", f"{spec} cannot be read: {error}", _again())
    if shutil.which(program) is None:
        return Finding(name, "missing", f"it starts {program}, which is not there", _again())
    wrong = [key for key, value in jupyter_files.KERNEL_VARIABLES.items() if variables.get(key) != value]
    if wrong:
        detail = f"it does not set {', '.join(wrong)}: log lines would cost points"
        return Finding(name, "missing", detail, _again())
    return Finding(name, "ok", program)


def space() -> list[Finding]:
    """Check the disk space and the shared memory."""
    folder = ROOT if IS_CLONE else Path.cwd()
    whose = (
        f"Have {owner(folder)}, whose folder it is, type what changes it, such as: ./course setup"
        if IS_CLONE
        else "Type it in a folder of your own."
    )
    found = [folder_space("Disk", folder, _DISK_NEEDED, "Make room on the disk.", whose)]
    remedy = "In a container: docker run --shm-size=512m …; or set FASTDDS_BUILTIN_TRANSPORTS=UDPv4"
    return [*found, folder_space("Shared memory", Path("/dev/shm"), _SHM_NEEDED, remedy)]


def folder_space(name: str, folder: Path, needed: int, remedy: str, not_yours: str = "") -> Finding:
    """Check a folder that must be writable and have enough free space.

    Args:
        name: The name of the folder in the report.
        folder: The path of the folder.
        needed: The required free space, in bytes.
        remedy: What to do if there is too little space.
        not_yours: What to do if the folder belongs to another user; the same as ``remedy`` if empty.
    """
    if not folder.is_dir():
        return Finding(name, "missing", f"the folder {folder} does not exist", remedy)
    if not may_write(folder):
        return Finding(name, "missing", f"{folder} is not yours to write to", not_yours or remedy)
    free = shutil.disk_usage(folder).free
    detail = f"{free / 1e9:.1f} GB free in {folder}"
    if free < needed:
        return Finding(name, "missing", f"{detail}, {needed / 1e9:.2f} GB are needed", remedy)
    return Finding(name, "ok", detail)


def sandbox() -> list[Finding]:
    """Check whether submissions can be isolated in boxes, and what enforces the limits of a box."""
    name = "Sandbox"
    path = shutil.which("bwrap")
    if path is None:
        return _not_there("sandbox")
    # A separate process, because this one must also run if the course's package is not installed yet.
    line = _last_line(_output(python_child("-m", "autograder.boxes.sandbox"))[1])
    try:
        report = json.loads(line)
        why, guards = report["why_impossible"], report["guards"]
    except (ValueError, LookupError, TypeError):
        return [Finding(name, "unchecked", f"boxes cannot be looked at: {line}")]
    if why:
        return [
            Finding(name, "optional", f"none is possible here: {why}", "It is needed to grade a class only.")
        ]
    bubblewrap = _first_line(_output([path, "--version"])[1])
    found = [Finding(name, "ok", f"a program was run in a box ({bubblewrap}, {path})")]
    return found + [Finding(f"Limit on {limit}", "ok", guard) for limit, guard in guards.items()]


def for_tests() -> list[Finding]:
    """Check what only ./course test uses."""
    chromium = system_packages.find_program(*system_packages.CHROMIUM_NAMES)
    return [Finding("Chromium", "ok", chromium)] if chromium else _not_there("tests")


def _not_there(need: system_packages.Need) -> list[Finding]:
    apt = system_packages.Apt.here()
    return [
        Finding(
            row.title,
            "optional",
            f"not there, only needed {row.reason}",
            system_packages.get_with([row], apt),
        )
        for row in system_packages.missing(need)
    ]


def for_more() -> list[Finding]:
    """Check what builds packages, and Jupyter. A wheel can judge programs without them."""
    found = [*build_tools(), *jupyter()]
    if IS_CLONE:
        return found
    return [replace(one, state="optional") if one.state == "missing" else one for one in found]


PROBES = (python, ros, talk, for_more, space, sandbox, *([for_tests] if IS_CLONE else []))


def examine() -> list[Finding]:
    """Run all probes, which takes about two seconds, and return the findings in order."""
    # Most probes wait for a process, so three run at a time.
    with ThreadPoolExecutor(3) as pool:
        return [finding for found in pool.map(lambda probe: probe(), PROBES) for finding in found]


def main(arguments: list[str] | None = None) -> int:
    """Print the findings. Return the exit code: 0 if the course can run, 1 if something is missing."""
    parser = argparse.ArgumentParser("python -m course_runtime.doctor", description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print the findings as a JSON list")
    options = parser.parse_args(arguments)
    findings = examine()
    print(
        json.dumps([asdict(finding) for finding in findings], indent=1) if options.json else as_text(findings)
    )
    return exit_code(findings)


if __name__ == "__main__":
    sys.exit(main())
