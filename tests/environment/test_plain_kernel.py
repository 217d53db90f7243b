"""The course in a Jupyter kernel that knows nothing of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from environment import plain_kernel
from environment.plain_kernel import NotSetUp

LOADED = "from pathlib import Path; print(Path('/proc/self/maps').read_text())"


def library(file: Path, *needs: Path) -> Path:
    """Compile a library that needs others, which its loader will not find by itself."""
    file.parent.mkdir(exist_ok=True)
    source = file.with_suffix(".c")
    source.write_text(f"int {file.name.split('.')[0].replace('-', '_')}(void) {{ return 1; }}\n")
    linked = [word for need in needs for word in (f"-L{need.parent}", f"-l:{need.name}")]
    command = ["cc", "-shared", "-o", file, f"-Wl,-soname,{file.name},--no-as-needed", source, *linked]
    subprocess.run(list(map(str, command)), check=True)
    return file


def loaded(names: str, *folders: Path) -> set[str]:
    """The names of the libraries below the folders that a new process has, once it has loaded these of the first."""
    code = (
        "import sys; from pathlib import Path; from environment.plain_kernel import load_libraries\n"
        "folders = [Path(word) for word in sys.argv[2:]]\n"
        "load_libraries([folders[0] / name for name in sys.argv[1].split()], folders)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code + LOADED, names, *map(str, folders)],
        cwd=plain_kernel.ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return {
        Path(line.split()[-1]).name for line in done.stdout.splitlines() if str(folders[0].parent) in line
    }


def test_a_library_is_loaded_after_what_it_needs_and_nothing_that_nobody_needs(tmp_path: Path) -> None:
    """With Python 3.13, ``libtracetools_status.so``, which nobody needs, brings a second ``libtracetools.so``.

    The two end a process.
    """
    lib, beside = tmp_path / "lib", tmp_path / "beside"
    needed = library(beside / "libneeded-0a1b2c3d.so")
    library(lib / "libtrace.so")
    library(lib / "libtrace_status.so", library(beside / "libtrace-0c4e6f54.so"))
    last = library(lib / "libz.so", needed)
    library(lib / "liba.so", last)
    assert loaded("liba.so libz.so", lib, beside) == {"liba.so", "libz.so", "libneeded-0a1b2c3d.so"}


def test_what_needs_a_file_that_is_nowhere_is_left_out(tmp_path: Path) -> None:
    lib = tmp_path / "lib"
    gone = library(tmp_path / "gone" / "libgone.so")
    library(lib / "liba.so", gone)
    library(lib / "libb.so")
    gone.unlink()
    assert loaded("liba.so libb.so", lib) == {"libb.so"}


def test_a_python_that_is_too_old_says_which_ones_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "version_info", (3, 10, 13))
    with pytest.raises(NotSetUp, match=r"needs Python 3\.11 to 3\.14, and this kernel is Python"):
        plain_kernel.set_up()


def test_a_set_up_that_fails_shows_its_lines_and_ends_the_cell(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "course").write_text('echo "course: error: the disk is full" >&2; exit 2\n')
    with pytest.raises(NotSetUp, match="the lines above say why") as caught:
        plain_kernel.run_set_up(tmp_path)
    assert "the disk is full" in capsys.readouterr().out
    assert caught.value._render_traceback_() == [str(caught.value)]


def test_an_environment_of_another_python_is_not_joined(tmp_path: Path) -> None:
    before = list(sys.path)
    with pytest.raises(NotSetUp, match="delete that folder and run this cell again"):
        plain_kernel.join(tmp_path)
    assert sys.path == before
