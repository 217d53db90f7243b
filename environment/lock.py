"""Resolve the dependencies into hashed lock files: ``python3 -m environment.lock [--upgrade | --wheels FOLDER]``.

The lock files in ``requirements/`` come from one resolution, which is cut into the parts that a set-up installs
separately:

* ``uv.lock``: uv, which installs the others, and resolves them here;
* ``course.lock``: the dependencies of pyproject.toml, those of a class, and the build tools;
* ``ros.lock``: the ROS wheels and their other dependencies, left out if a Jazzy is sourced;
* ``dev.lock``: what only ``./course test`` needs;
* ``cluster.lock``, ``postgresql.lock``, ``site.lock``: what only the extra with that name needs, installed on
  request.

Without ``--upgrade`` a version that is locked stays as long as the inputs allow it. The locks name no package
index: that is what pip is configured for, and the hashes make sure that it is the same file.

With ``--wheels FOLDER`` nothing is resolved: the files of the locks are downloaded into the folder, for this very
version of Python. ``./course setup --wheels FOLDER`` installs from it, without a network.
"""

from __future__ import annotations

import argparse
import hashlib
import re  # noqa: TID251  (not what a student handed in)
import subprocess
import sys
import tempfile  # noqa: TID251  (without the package, on the machine of whoever pins versions)
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

from course_runtime.python_child import INTERPRETER

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / "environment" / "requirements"
EXTRAS = ("cluster", "postgresql", "site")
COURSE = ("--extra", "class")
"""The extras that the course itself is installed with: ROS is in a lock of its own."""
LOCKS = ("uv", "course", "ros", "dev", *EXTRAS)

# The oldest Python of the project. The resolution is universal, and markers in it cover newer versions.
OLDEST_PYTHON = "3.11"

_HEADER = """\
# Written by `python3 -m environment.lock`, do not edit. {purpose}
# inputs sha256:{digest}
"""
_PURPOSE = {
    "uv": "The installer of the other locks.",
    "course": "The packages of the course and its autograder.",
    "ros": "ROS 2 Jazzy as wheels, and what only they need.",
    "dev": "More packages for the checks and tests of the project.",
    "cluster": "More packages for grading on a Dask cluster.",
    "postgresql": "More packages for a gradebook in PostgreSQL.",
    "site": "More packages for the course as a book of HTML pages.",
}
_BLOCK_START = re.compile(r"^([A-Za-z0-9][A-Za-z0-9._-]*)==")


def inputs_digest(root: Path = ROOT) -> str:
    """Return the SHA-256 (hexadecimal) of everything from which a lock is made.

    Of pyproject.toml only the dependency lists count, so that other edits of it leave the locks valid.
    """
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lists = [sorted(project["dependencies"])]
    lists += [[extra, *sorted(names)] for extra, names in sorted(project["optional-dependencies"].items())]
    digest = hashlib.sha256(repr(lists).encode())
    for name in ("ros.in", "tools.in"):
        text = (root / "environment" / "requirements" / name).read_text(encoding="utf-8")
        wanted = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("#")]
        digest.update(repr(sorted(wanted)).encode())
    return digest.hexdigest()


def split_blocks(lock: str) -> list[tuple[str, str]]:
    """Yield the parts of a lock file in order: a name, and its requirement with hashes and comments.

    A name may come several times, with different markers.
    """
    blocks: list[tuple[str, list[str]]] = []
    for line in lock.splitlines():
        start = _BLOCK_START.match(line)
        if start:
            blocks.append((start.group(1), [line]))
        elif line.startswith(" ") and blocks:
            blocks[-1][1].append(line)
    return [(name, "\n".join(lines)) for name, lines in blocks]


def cut(everything: str, course: set[str], extras: Mapping[str, set[str]]) -> dict[str, str]:
    """Cut one resolution into the bodies of the locks.

    Dependencies of the course are in its lock alone. Other dependencies of several extras are in each of their locks,
    since any of them may be installed without the others.

    Args:
        everything: The text of the whole resolution.
        course: The names of the packages that the course needs without ROS.
        extras: The names of the packages that each extra needs.
    """
    bodies: dict[str, list[str]] = {name: [] for name in LOCKS}
    for name, block in split_blocks(everything):
        wanting = [extra for extra, names in extras.items() if name in names]
        for part in ["uv"] if name == "uv" else ["course"] if name in course else wanting or ["ros"]:
            bodies[part].append(block)
    return {part: "\n".join(blocks) + "\n" for part, blocks in bodies.items()}


def _names(lock: str) -> set[str]:
    return {name for name, _ in split_blocks(lock)}


def _resolve(resolver: Path, work: Path, inputs: list[Path], *options: str) -> str:
    """Run the resolver on the inputs and return the lock it prints."""
    command = [
        *(str(resolver), "pip", "compile", "--quiet", "--universal", "--python-version", OLDEST_PYTHON),
        *("--no-emit-index-url", "--no-header", "--output-file", str(work)),
        *options,
        *(str(path.relative_to(ROOT)) for path in inputs),
    ]
    subprocess.run(command, check=True, cwd=ROOT)
    return work.read_text(encoding="utf-8")


def fill(folder: Path, locks: Sequence[str] = LOCKS) -> int:
    """Download the files that a set-up installs, checked by their hashes. Return pip's exit code.

    The Python that runs this must have exactly the version that will install the files, because some locks depend on
    it.
    """
    command = [
        INTERPRETER,
        "-m",
        "pip",
        "download",
        "--disable-pip-version-check",
        "--quiet",
        "--dest",
        str(folder),
    ]
    command += [
        "--require-hashes",
        "--no-deps",
        "--only-binary=:all:",
        "--no-binary=empy",
        "--no-build-isolation",
    ]
    command += [word for lock in locks for word in ("--requirement", str(REQUIREMENTS / f"{lock}.lock"))]
    code = subprocess.run(command, check=False).returncode
    if code == 0:
        print(f"{folder} has {len(list(folder.iterdir()))} files. Type: ./course setup --wheels {folder}")
    return code


def main(arguments: list[str] | None = None) -> int:
    """Write the lock files."""
    parser = argparse.ArgumentParser(prog="python3 -m environment.lock", description=__doc__.splitlines()[0])
    parser.add_argument("--upgrade", action="store_true", help="take the newest versions the inputs allow")
    parser.add_argument("--wheels", type=Path, help="fill this folder with the files of the locks instead")
    options = parser.parse_args(arguments)
    if options.wheels:
        return fill(options.wheels)
    upgrade = ["--upgrade"] if options.upgrade else []
    pyproject, tools, ros = ROOT / "pyproject.toml", REQUIREMENTS / "tools.in", REQUIREMENTS / "ros.in"
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        uv = ROOT / ".venv/bin/uv"
        everything = work / "everything.txt"
        # The resolver prefers the versions that it finds in its output file.
        locked = [REQUIREMENTS / f"{name}.lock" for name in LOCKS]
        everything.write_text("".join(path.read_text(encoding="utf-8") for path in locked if path.exists()))
        extras = [word for extra in ("dev", *EXTRAS) for word in ("--extra", extra)]
        _resolve(uv, everything, [ros, tools, pyproject], "--generate-hashes", *COURSE, *extras, *upgrade)
        same = ("--constraint", str(everything), "--no-annotate")
        course = _resolve(uv, work / "course.txt", [tools, pyproject], *COURSE, *same)
        wanted = {
            extra: _resolve(uv, work / f"{extra}.txt", [tools, pyproject], *COURSE, "--extra", extra, *same)
            for extra in ("dev", *EXTRAS)
        }
        bodies = cut(
            everything.read_text(encoding="utf-8"),
            _names(course),
            {extra: _names(lock) for extra, lock in wanted.items()},
        )
    for name, body in bodies.items():
        header = _HEADER.format(purpose=_PURPOSE[name], digest=inputs_digest())
        (REQUIREMENTS / f"{name}.lock").write_text(header + body, encoding="utf-8")
        print(f"{name}.lock: {len(split_blocks(body))} requirements")
    return 0


if __name__ == "__main__":
    sys.exit(main())
