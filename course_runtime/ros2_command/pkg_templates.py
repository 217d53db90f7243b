"""The files of a new package, as `ros2 pkg create` writes them on Jazzy."""

from __future__ import annotations

from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

# The linters of ament are not on the package index. If they are missing, the generated tests are skipped.
PYTHON_TEST_DEPENDENCIES = ("ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest")
CMAKE_TEST_DEPENDENCIES = ("ament_lint_auto", "ament_lint_common")


@dataclass(frozen=True)
class Package:
    """A new package, as the command line describes it."""

    name: str
    build_type: str
    package_format: int
    description: str
    license: str
    maintainer: str
    email: str
    dependencies: tuple[str, ...]
    node_name: str | None


def package_xml(package: Package) -> str:
    """Return package.xml."""
    python = package.build_type == "ament_python"
    groups = [
        [] if python else ["  <buildtool_depend>ament_cmake</buildtool_depend>"],
        [f"  <depend>{escape(name)}</depend>" for name in package.dependencies],
        [
            f"  <test_depend>{name}</test_depend>"
            for name in (PYTHON_TEST_DEPENDENCIES if python else CMAKE_TEST_DEPENDENCIES)
        ],
    ]
    depends = "".join("\n".join(group) + "\n\n" for group in groups if group)
    schema = f"http://download.ros.org/schema/package_format{package.package_format}.xsd"
    return f"""\
<?xml version="1.0"?>
<?xml-model href="{schema}" schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="{package.package_format}">
  <name>{escape(package.name)}</name>
  <version>0.0.0</version>
  <description>{escape(package.description)}</description>
  <maintainer email={quoteattr(package.email)}>{escape(package.maintainer)}</maintainer>
  <license>{escape(package.license)}</license>

{depends}  <export>
    <build_type>{package.build_type}</build_type>
  </export>
</package>
"""


def setup_py(package: Package) -> str:
    """Return setup.py, with the entry point of the node if there is one."""
    name = package.node_name
    entry = f"            '{name} = {package.name}.{name}:main'\n" if name else ""
    return f"""\
from setuptools import find_packages, setup

package_name = {package.name!r}

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages',
            ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer={package.maintainer!r},
    maintainer_email={package.email!r},
    description={package.description!r},
    license={package.license!r},
    extras_require={{
        'test': [
            'pytest',
        ],
    }},
    entry_points={{
        'console_scripts': [
{entry}        ],
    }},
)
"""


def setup_cfg(package: Package) -> str:
    """Return setup.cfg, which says where `ros2 run` finds the programs."""
    folder = f"$base/lib/{package.name}"
    return f"[develop]\nscript_dir={folder}\n[install]\ninstall_scripts={folder}\n"


def python_node(package: Package) -> str:
    """Return the module of the node."""
    return f"""\
def main():
    print('Hi from {package.name}.')


if __name__ == '__main__':
    main()
"""


def cpp_node(package: Package) -> str:
    """Return the C++ source of the node."""
    return f"""\
#include <cstdio>

int main(int argc, char ** argv)
{{
  (void) argc;
  (void) argv;

  printf("hello world {package.name} package\\n");
  return 0;
}}
"""


_LINTERS = {
    "copyright": ("ament_copyright", "main(argv=['.', 'test'])", "the copyright of a file"),
    "flake8": ("ament_flake8", "main_with_errors(argv=[])[0]", "the code style"),
    "pep257": ("ament_pep257", "main(argv=['.', 'test'])", "the docstrings"),
}


def linter_test(linter: str) -> str:
    """Return the test that runs one of the linters: copyright, flake8 or pep257."""
    module, call, subject = _LINTERS[linter]
    # As on Jazzy, a package without copyright headers does not fail right away.
    skip = (
        "# Remove this mark when the files of the package have a copyright header.\n"
        "@pytest.mark.skip(reason='The generated files have no copyright header.')\n"
        if linter == "copyright"
        else ""
    )
    return f"""\
import pytest

{linter} = pytest.importorskip('{module}.main')


{skip}@pytest.mark.{linter}
@pytest.mark.linter
def test_{linter}():
    assert {linter}.{call} == 0, 'found errors in {subject}'
"""


def cmake_lists(package: Package) -> str:
    """Return CMakeLists.txt."""
    found = "".join(f"find_package({name} REQUIRED)\n" for name in package.dependencies) or (
        "# Further dependencies go here, each in a line like this:\n# find_package(<dependency> REQUIRED)\n"
    )
    return f"""\
cmake_minimum_required(VERSION 3.10)
project({package.name})

if(CMAKE_COMPILER_IS_GNUCXX OR CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-Wall -Wextra -Wpedantic)
endif()

# find dependencies
find_package(ament_cmake REQUIRED)
{found}{_cmake_node(package)}
if(BUILD_TESTING)
  # If the linters are not installed, there is nothing to run.
  find_package(ament_lint_auto QUIET)
  if(ament_lint_auto_FOUND)
    # Remove these two lines when the package is in a git repository and its files have a copyright header.
    set(ament_cmake_copyright_FOUND TRUE)
    set(ament_cmake_cpplint_FOUND TRUE)
    ament_lint_auto_find_test_dependencies()
  endif()
endif()

ament_package()
"""


def _cmake_node(package: Package) -> str:
    name = package.node_name
    if not name:
        return ""
    links = "".join(f'\n  "{dependency}"' for dependency in package.dependencies)
    depend = f"ament_target_dependencies(\n  {name}{links}\n)\n" if links else ""
    return f"""
add_executable({name} src/{name}.cpp)
target_include_directories({name} PUBLIC
  $<BUILD_INTERFACE:${{CMAKE_CURRENT_SOURCE_DIR}}/include>
  $<INSTALL_INTERFACE:include/${{PROJECT_NAME}}>)
target_compile_features({name} PUBLIC c_std_99 cxx_std_17)  # C99 and C++17
{depend}
install(TARGETS {name}
  DESTINATION lib/${{PROJECT_NAME}})
"""
