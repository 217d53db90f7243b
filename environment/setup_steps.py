"""The steps that make the environment of the course, and the inputs of each step.

Only the standard library is used: this runs before anything is installed.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import subprocess
import sys
import tempfile  # noqa: TID251  (this runs before the package is installed)
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING

from course_runtime import course_process, ros_flavour
from course_runtime.interface_packages import build_command, only_python_needs
from course_runtime.jupyter_files import kernel_install_options, write_jupyter_files
from course_runtime.place import INTERFACES, Place, environment_paths, environment_values
from course_runtime.python_child import SEARCH_PATHS, listed_environment
from course_runtime.ros2_command.install import install as install_ros2_command
from environment.lock import EXTRAS, split_blocks
from environment.pip_settings import as_uv_has_them
from environment.steps import Step, files_below
from environment.wheel_repairs import repair_fast_dds, repair_sources

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from course_runtime.ros_flavour import Ros

    # A program and its arguments.
    Command = Sequence[str | Path]


_OF_BUILDS = (
    "HOME",
    "TMPDIR",
    "CC",
    "CXX",
    "CFLAGS",
    "CXXFLAGS",
    "CPPFLAGS",
    "LDFLAGS",
    "CMAKE_BUILD_PARALLEL_LEVEL",
)
_COMPILED = ("autograder", "course_runtime", "environment")


class SetupError(Exception):
    """The set-up cannot go on. The text says what to do about it."""


@dataclass(frozen=True)
class Setup:
    """One run of the set-up.

    Attributes:
        place: The paths of the environment.
        ros: The ROS 2 that is used.
        environ: The variables in which that ROS is sourced; for the wheels, those of the user.
        log: Receives the output of every command.
        say: Prints a line for the user.
    """

    place: Place
    ros: Ros
    environ: Mapping[str, str]
    log: IO[str]
    say: Callable[[str], None] = lambda _: None

    def steps(self, with_tests: bool, extras: Collection[str] = ()) -> list[Step]:
        """Return the steps in order. Those of the tests and of extras are included only if requested."""
        place = self.place
        locks = [place.lock("course")] if self.ros.is_sourced else [place.lock("course"), place.lock("ros")]
        # The notice is only for the user. It must not cause a new environment.
        ros = repr(replace(self.ros, notice=""))
        kind = (str(place.root), str(place.base_python), sys.version, ros)
        repairs = (place.root / "environment" / "wheel_repairs.py",)
        start = (place.runtime / "course_process.py", place.runtime / "place.py")
        ros2 = (place.runtime / "ros2_command" / "install.py",)
        jupyter = (place.runtime / "jupyter_files.py",)
        project = (place.root / "pyproject.toml",)
        python = f"Python {sys.version.split()[0]}"
        steps = [
            Step("environment", f"making .venv with {python}", kind, self._make_environment),
            Step("uv", "fetching uv, which installs the packages", (place.lock("uv"),), self._get_uv),
            Step("packages", self._what_is_installed(), tuple(locks), lambda: self._install_packages(locks)),
            Step("sources", "repairing imports and parameters", repairs, self._repair_sources),
            Step("fast_dds", "repairing how a node ends", repairs, lambda: repair_fast_dds(place.prefix)),
            *map(self._interfaces, place.interfaces),
            Step("start", "teaching its Python to find ROS", start, self._install_start),
            Step("ros2", "adding the ros2 command", ros2, lambda: install_ros2_command(place.prefix)),
            Step("jupyter", "configuring JupyterLab", jupyter, self._configure_jupyter),
            Step("project", "installing the autograder", project, self._install_project),
        ]
        if with_tests:
            extras = (
                "dev",
                *EXTRAS,
            )  # these are installed in one call, because each call of an installer takes seconds
            steps.append(self._extra("dev", "installing what the tests need", extras))
        else:
            steps += [self._extra(name, f"installing what the extra {name} needs", [name]) for name in extras]
        return steps

    def _interfaces(self, package: Path) -> Step:
        """Return the step that builds a package of interfaces. No such package needs another one of the course."""
        makers = (
            "environment/wheel_repairs.py",
            "course_runtime/interface_packages.py",
            "course_runtime/only_python.cmake",
        )
        inputs = (*(self.place.root / name for name in makers), *files_below(package))
        return Step(
            f"interfaces_{package.name}",
            f"building {package.name} with colcon",
            inputs,
            lambda: self._build_interfaces(package),
            stands_alone=True,
        )

    def _extra(self, name: str, doing: str, extras: Collection[str]) -> Step:
        locks = tuple(map(self.place.lock, extras))
        return Step(name, doing, locks, lambda: self._install(*locks))

    def _what_is_installed(self) -> str:
        if self.ros.is_sourced:
            return (
                f"using the sourced ROS 2 Jazzy ({self.ros.flavour}), installing Jupyter and the build tools"
            )
        return "installing ROS 2 Jazzy, Jupyter and the build tools (a minute or two, longer if the computer is busy)"

    def _run(self, what: str, command: Command, environment: Mapping[str, str] | None = None) -> None:
        """Run a command, with its output in the log.

        Args:
            what: The purpose of the command, for the message if it fails.
            command: The program and its arguments.
            environment: All environment variables; None for what a build needs, because colcon writes its environment
                into files.

        Raises:
            SetupError: The command failed.
        """
        words = [str(word) for word in command]
        print(f"\n$ {shlex.join(words)}", file=self.log, flush=True)
        done = subprocess.run(
            words,
            env=self._build_variables() if environment is None else environment,
            cwd=self.place.root,
            stdin=subprocess.DEVNULL,
            stdout=self.log,
            stderr=subprocess.STDOUT,
            check=False,
        )
        if done.returncode != 0:
            raise SetupError(f"{what} failed")

    def _build_variables(self) -> dict[str, str]:
        """Return the variables that a build needs, which lead only to the chosen ROS and this environment."""
        kept = listed_environment(self.environ, *_OF_BUILDS)
        found = {name: value for name, value in kept.items() if name not in SEARCH_PATHS or name == "PATH"}
        return self._with_the_courses(found)

    def _installer_variables(self) -> dict[str, str]:
        """Return the user's variables, which say how pip and uv reach a package index."""
        result = self._with_the_courses(self.environ)
        for name in ("PYTHONHOME", "PYTHONSAFEPATH"):
            result.pop(name, None)
        return result

    def _with_the_courses(self, environ: Mapping[str, str]) -> dict[str, str]:
        paths, values = environment_paths(self.place, self.ros), environment_values(self.place)
        return {**environ, **course_process.variables(paths, values, environ)}

    def _make_environment(self) -> None:
        place = self.place
        if place.prefix.exists():
            _empty(place.prefix, keep=place.notes)
            shutil.rmtree(place.notes / "stamps", ignore_errors=True)
        # A sourced ROS needs the system's Python packages (numpy, yaml, …) in the versions with which it was built.
        options = ["--system-site-packages"] if self.ros.is_sourced else []
        self._run("making .venv", [place.base_python, "-m", "venv", *options, place.prefix])
        ros_flavour.save(self.ros, place.prefix)

    def _get_uv(self) -> None:
        try:
            self._pip(
                "--require-hashes", "--no-deps", "--only-binary=:all:", "-r", str(self.place.lock("uv"))
            )
        except SetupError:
            self.say("uv cannot be had here: pip installs the packages, which takes longer")

    def _install_packages(self, locks: Sequence[Path]) -> None:
        # One requirement exists as source only. It is built by the setuptools of the lock, which is installed
        # first for that: an isolated build would download an unpinned version.
        blocks = split_blocks(self.place.lock("course").read_text(encoding="utf-8"))
        backend = self.place.notes / "build-backend.lock"
        backend.write_text("\n".join(block for name, block in blocks if name == "setuptools") + "\n", "utf-8")
        self._install(backend)
        self._install(*locks)

    def _install(self, *locks: Path) -> None:
        files = [word for lock in locks for word in ("-r", str(lock))]
        self._uv_or_pip("--require-hashes", "--no-deps", "--only-binary=:all:", "--no-binary=empy", *files)

    def _uv_or_pip(self, *arguments: str) -> None:
        """Install with options that both pip and uv have."""
        if os.access(self._uv_program, os.X_OK):
            try:
                self._uv(*arguments)
            except SetupError:
                self.say("uv could not install the packages: pip tries, which takes longer")
                self._uv_program.unlink()  # a failure here would happen in the next step, too
            else:
                return
        self._pip(*arguments)

    @property
    def _uv_program(self) -> Path:
        return self.place.prefix / "bin" / "uv"

    def _uv(self, *arguments: str) -> None:
        """Install with uv, from the package index that the user's pip would use."""
        asked: Command = [self.place.python, "-m", "pip", "config", "list"]
        own = self._installer_variables()
        listed = subprocess.run(asked, env=own, capture_output=True, text=True, check=False)
        options, variables = as_uv_has_them(listed.stdout)
        command: list[str | Path] = [self._uv_program, "pip", "install", "--no-config", "--no-progress"]
        command += ["--python", self.place.python, "--no-build-isolation", "--compile-bytecode"]
        # Copied, not linked: a changed file in this environment must not change uv's cache. pip, too, takes the
        # best of all indexes; the hashes say which file that is.
        options = [option for option in options if option not in arguments]  # uv accepts no option twice
        command += ["--link-mode=copy", "--index-strategy=unsafe-best-match", *options, *arguments]
        self._run("installing packages", command, {**own, **variables})

    def _pip(self, *arguments: str) -> None:
        command: list[str | Path] = [self.place.python, "-m", "pip", "install", "--disable-pip-version-check"]
        command += ["--progress-bar=off", "--no-build-isolation", "--use-pep517", *arguments]
        # If a user's setting makes pip install into the home folder, pip would refuse to do so inside an environment.
        self._run("installing packages", command, {**self._installer_variables(), "PIP_USER": "0"})

    def _repair_sources(self) -> None:
        changed = repair_sources(self.place.site_packages)
        if changed:
            # For a user who may read this environment but not write to it.
            self._run("compiling what was changed", [self.place.python, "-m", "compileall", "-q", *changed])

    def _build_interfaces(self, package: Path) -> None:
        place = self.place
        if not self.ros.is_sourced:
            self._run("repairing the wheels", [place.python, "-m", "environment.wheel_repairs"])
        # Merged into the environment itself: its lib folder and its site-packages are searched already.
        # With a ROS that was sourced, programs in C++ may use them.
        light = not self.ros.is_sourced and only_python_needs(package)
        colcon = place.prefix / "bin/colcon"
        # Only this user can read the folder, and no box sees it.
        with tempfile.TemporaryDirectory(prefix="course-setup-", ignore_cleanup_errors=True) as scratch:
            command = build_command(colcon, place.python, [package], place.prefix, Path(scratch), light=light)
            self._run(f"building {package.name}", command)

    def _install_start(self) -> None:
        """Install the code that every Python of the environment runs at its start; see course_process.py."""
        site_packages = self.place.site_packages
        paths, values = environment_paths(self.place, self.ros), environment_values(self.place)
        shutil.copyfile(self.place.runtime / "course_process.py", site_packages / "course_process.py")
        written = '"""Written by the set-up of the course."""\n'
        (site_packages / "course_paths.py").write_text(
            f"{written}\nPATHS = {paths!r}\nVALUES = {values!r}\n", "utf-8"
        )
        # The name sorts before ros_wheels_bootstrapper.pth, so this file is run first.
        (site_packages / "course_process.pth").write_text(
            "import course_process; course_process.begin()\n", "utf-8"
        )
        wanted = course_process.variables(paths, values, {})
        names = [name for name in course_process.READ_AT_START if name in wanted]
        exports = "".join(f"export {name}={shlex.quote(wanted[name])}\n" for name in names)
        (self.place.notes / "libraries.sh").write_text(exports, encoding="utf-8")
        built = ", ".join(package.name for package in self.place.interfaces)
        check = f"import rclpy, {INTERFACES}.action, {INTERFACES}.srv, {built}"
        self._run("importing rclpy and the interfaces", [self.place.python, "-c", check])

    def _configure_jupyter(self) -> None:
        write_jupyter_files(self.place.prefix, self.place.root)
        install: Command = [self.place.python, "-m", "ipykernel", "install", *kernel_install_options()]
        self._run("registering the kernel", install)

    def compile_modules(self) -> None:
        """Compile those of the course's own modules that have changed.

        If a user's Python writes no bytecode (``PYTHONDONTWRITEBYTECODE``), or the folder belongs to another user,
        each process would compile its imports again. A module that is being edited may be broken; the code that
        imports it will report that.
        """
        root = self.place.root
        labs = [file for name in ("solutions", "exercises") for file in sorted(root.glob(f"{name}/*/*/*.py"))]
        command: Command = [self.place.python, "-m", "compileall", "-q", *_COMPILED, *labs]
        with contextlib.suppress(SetupError):
            self._run("compiling the course's modules", command)

    def _install_project(self) -> None:
        # "compat" puts the folder itself on the path, so that `environment` can be imported too.
        compat = ("--config-settings", "editable_mode=compat")
        self._uv_or_pip("--no-deps", "--no-index", *compat, "--editable", str(self.place.root))


def _empty(folder: Path, keep: Path) -> None:
    """Delete everything in a folder except one entry."""
    for entry in folder.iterdir():
        if entry == keep:
            continue
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry)
        else:
            entry.unlink()
