"""Packages as their files describe them, and the key of their sources."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

from autograder.messages.workspace_messages import Source
from autograder.workspaces import packages
from autograder.workspaces.builds import cached_builds
from autograder.workspaces.builds.simplified_sources import simplified
from autograder.workspaces.sources import BadSources, SourceTree

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import CMAKE, PACKAGE_XML, interface_package, packages_in


def test_a_package_is_read_and_not_run(workspace: Path) -> None:
    (package,) = packages_in(workspace / "src")
    assert (package.name, package.build_type) == ("tiny_pkg", "ament_python")
    assert package.programs == ("hello = tiny_pkg.hello:main",)


def test_a_line_inside_a_comment_is_no_dependency_and_is_told(workspace: Path) -> None:
    file = workspace / "src" / "tiny_pkg" / "package.xml"
    hidden = "<!--\n <depend> rclpy </depend>\n <member_of_group>a_group</member_of_group> -->"
    file.write_text(file.read_text().replace("</package>", f"{hidden}</package>"))
    (package,) = packages_in(workspace / "src")
    assert package.commented == ("rclpy", "a_group")
    assert "a_group" not in package.dependencies


def test_an_ignored_package_is_none(workspace: Path) -> None:
    ignored = workspace / "src" / "ignored_pkg"
    shutil.copytree(workspace / "src" / "tiny_pkg", ignored)
    (ignored / "COLCON_IGNORE").touch()
    assert [package.name for package in packages_in(workspace / "src")] == ["tiny_pkg"]


def trouble_in(src: Path) -> str:
    """What is wrong with the one package below a folder."""
    found, (trouble,) = packages.find_packages(src)
    assert found == []
    return trouble


def key_of(src: Path) -> str:
    return cached_builds.build_key(packages.sources_of(src, packages_in(src)))


def test_the_key_is_of_bytes_names_and_bits(workspace: Path) -> None:
    src = workspace / "src"
    module = src / "tiny_pkg" / "tiny_pkg" / "hello.py"
    keys = [key_of(src)]
    module.write_text(module.read_text() + "\n")
    keys.append(key_of(src))
    module.chmod(0o755)
    keys.append(key_of(src))
    module.rename(module.with_name("hallo.py"))
    keys.append(key_of(src))
    assert len(set(keys)) == 4


def test_the_toolchain_is_in_the_key(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = key_of(workspace / "src")
    monkeypatch.setenv("CXXFLAGS", "-O0")
    assert key_of(workspace / "src") != before


def test_a_sourced_ros_and_its_version_are_in_the_key(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    keys = [key_of(workspace / "src")]
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'nothing'}:{tmp_path / 'ros'}")
    generators = tmp_path / "ros" / "share" / "rosidl_default_generators" / "package.xml"
    generators.parent.mkdir(parents=True)
    for text in ("1.6.0", "1.6.0-2"):
        generators.write_text(text)
        keys.append(key_of(workspace / "src"))
    assert len(set(keys)) == 3


def test_what_cmake_includes_is_in_the_key_and_not_its_path_alone(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = key_of(workspace / "src")
    monkeypatch.setattr(cached_builds, "ONLY_PYTHON_FILE", tmp_path / "another.cmake")
    (tmp_path / "another.cmake").write_text("# another\n")
    assert key_of(workspace / "src") != before


def test_far_too_much_is_refused(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packages, "MAX_FILES", 2)
    with pytest.raises(BadSources, match="is it a workspace"):
        key_of(workspace / "src")


@pytest.mark.parametrize(
    "content",
    [
        b"<?xml version='1.0' encoding='nonsense'?><package/>",
        b"<?xml version='1.0' encoding='shift_jis'?><package/>",
        "<?xml version='1.0' encoding='utf-16'?><package><name>tiny_pkg</name></package>".encode("utf-16"),
        b"<package><name>tiny_pkg</name>" + b"<a>" * 2_500 + b"</a>" * 2_500 + b"</package>",
    ],
    ids=["unknown encoding", "several bytes a character", "UTF-16", "deep"],
)
def test_an_odd_package_file_is_the_packages_own_fault(workspace: Path, content: bytes) -> None:
    (workspace / "src" / "tiny_pkg" / "package.xml").write_bytes(content)
    assert "is not valid" in trouble_in(workspace / "src")
    text = content.decode("utf-8", "replace").encode()
    assert simplified(SourceTree((Source("tiny_pkg/package.xml", text),))).sources[0].data


def test_a_format_that_does_not_exist_is_the_packages_own_fault(workspace: Path) -> None:
    # catkin_pkg asserts that it is one of three: that was "could not be checked" in place of a diagnosis.
    file = workspace / "src" / "tiny_pkg" / "package.xml"
    file.write_text(file.read_text().replace('format="3"', 'format="4"'))
    assert trouble_in(workspace / "src") == (
        'tiny_pkg/package.xml is not valid: <package format="…"> has to be 1, 2 or 3'
    )


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_package_file_is_not_longer_than_it_looks(
    workspace: Path, encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Two thousand bytes stood for 120,000 dependencies, and fifty such packages took minutes outside of any box.
    many = f"""<!ENTITY a "<depend>x</depend>"><!ENTITY b "{"&a;" * 400}">"""
    content = f"<!DOCTYPE package [{many}]><package><name>tiny_pkg</name>{'&b;' * 300}</package>"
    (workspace / "src" / "tiny_pkg" / "package.xml").write_text(content, encoding)
    monkeypatch.setattr(packages, "MAX_LOOK", 0)  # of many packages, the last are not validated
    assert trouble_in(workspace / "src") == "tiny_pkg/package.xml " + (
        "declares an entity with <!ENTITY: replace the entity by its text"
        if encoding == "utf-8"
        else "is not valid: save it in UTF-8"
    )


def test_a_package_file_with_thousands_of_dependencies_is_not_validated(workspace: Path) -> None:
    # catkin_pkg compares each of them with each other: 20,000 took minutes, outside of any box.
    depends = "".join(f"<depend>p{number}</depend>" for number in range(1_000))
    content = f"<package><name>tiny_pkg</name>{depends}</package>"
    (workspace / "src" / "tiny_pkg" / "package.xml").write_text(content)
    assert "larger than 20 kB" in trouble_in(workspace / "src")


def test_of_many_large_package_files_only_some_are_validated(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Half a second each: fifty took half a minute of a grader's worker, at each start of a program.
    validated: list[str] = []
    monkeypatch.setattr(packages, "_validate", lambda _, shown: validated.append(shown))
    content = PACKAGE_XML.replace("For a test", "x" * 18_000)
    for number in range(20):
        (folder := workspace / "src" / f"p{number}").mkdir()
        (folder / "package.xml").write_text(content.format(name=f"p{number}"))
    assert len(packages_in(workspace / "src")) == 21
    assert len(validated) == 6  # five of these, and the small one


def test_a_cmake_file_is_read_once_and_only_where_it_is_short(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A thousand interfaces beside 250,000 lines of comments took 25 minutes of a grader's worker.
    interface_package(workspace / "src" / "short", "# AddTwoInts_cpp\n")
    interface_package(workspace / "src" / "long", "#\n" * 30_000)
    reads: list[Path] = []
    text = packages._text

    def read(file: Path) -> str:
        reads.append(file)
        return text(file)

    monkeypatch.setattr(packages, "_text", read)
    long, short, _ = sorted(packages_in(workspace / "src"), key=lambda package: package.folder.name)
    assert short.cmake_lists == f"\n{CMAKE}"
    assert long.cmake_lists is None
    assert short.holds_only_interfaces
    assert not long.holds_only_interfaces
    assert len(reads) == 2


def test_nobody_looks_at_hundreds_of_packages(workspace: Path) -> None:
    for number in range(60):
        (folder := workspace / "src" / f"p{number}").mkdir()
        (folder / "package.xml").write_text("<package/>")
    assert "more than 50 packages below src" in trouble_in(workspace / "src")


@pytest.mark.parametrize(
    "deep",
    [
        "-" * 100_000 + "1",
        "+".join(["1"] * 100_000),
        "(" * 300 + ")" * 300,
        'f"' + "{1}" * 150_000 + '"',  # minutes for Python's parser
    ],
)
def test_a_setup_too_deep_to_be_read_has_no_programs(workspace: Path, deep: str) -> None:
    (workspace / "src" / "tiny_pkg" / "setup.py").write_text(deep)
    (package,) = packages_in(workspace / "src")
    assert package.programs == ()


def test_texts_in_setup_may_hold_what_is_no_text(workspace: Path) -> None:
    setup = workspace / "src" / "tiny_pkg" / "setup.py"
    setup.write_text(setup.read_text() + 'odd = """\\ud800 = a.b:c\nlater = tiny_pkg.later:main"""\n')
    (package,) = packages_in(workspace / "src")
    assert set(package.programs) == {"hello = tiny_pkg.hello:main", "later = tiny_pkg.later:main"}


def test_a_package_file_that_cannot_be_read_is_the_packages_own_fault(workspace: Path) -> None:
    file = workspace / "src" / "tiny_pkg" / "package.xml"
    file.unlink()
    file.symlink_to("nowhere")
    assert trouble_in(workspace / "src") == "tiny_pkg/package.xml cannot be read: No such file or directory"
