"""A recipe for a package that defines a service type. The judge builds it and compares the generated type."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.draft import OWN, SeenAsItIs
from autograder.kit.mistakes import package_mistakes
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.model import Advice, Finding, Mistake, card_words, filled_in
from autograder.kit.output.workspace_reports import AMENT_PACKAGE, Interface, PackageReport, report_of
from autograder.kit.runners import BUILDING, ServesInterface

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence

_WORDS = card_words(__file__)

GROUP = "rosidl_interface_packages"
"""The group in package.xml that marks a package as one that defines interfaces."""
NEEDED = ("rosidl_default_generators", "rosidl_default_runtime")
"""What an interface package must depend on, whatever the tag of the dependency."""
SERVICE = "/interface_of_the_workspace"
"""The name of the service that a program of the judge serves with the student's type, so that the type is visible on
the network.
"""
BEGINNING = 15.0
"""Time limit in seconds of wall time for reading the packages."""
PART = "building"
Fields = list[tuple[str, str]]
"""The fields of a request or a response: the type and the name of each, in order."""


class ServiceType(SeenAsItIs):
    """The recipe for a package that defines a service type. Its views are the whole evidence.

    The recipe recognizes the mistakes ``no_workspace``, ``bad_package``, ``build_failed``, ``three_dashes``,
    ``interface_fields``, ``interface_in_python_package``, ``member_of_group``, ``interface_not_listed``.

    Args:
        file: The name of the file in the task, such as ``"AddTwoInts.srv"``.
        package: The package's name in advice; the judge accepts any name.

    Example::

        recipe = ServiceType("AddTwoInts.srv", "my_robot_interfaces")
        interface = Draft("lab_8_1.interface", "Lab 8.1 · The interface", "A package with a service type.", recipe)
        interface.asks("fields", "Has the right fields", recipe.has_the_fields, points=4)
        interface.asks("builds", "Builds and generates the type", recipe.builds, points=3)
        interface.asks("wire", "Has the right type on the wire", recipe.is_on_the_wire, points=3)
        EXERCISE = interface.exercise(limit=400.0, runner=recipe.runner)
    """

    roles = ("service",)

    def __init__(self, file: str, package: str) -> None:
        self._file, self._package = file, package
        self.runner = ServesInterface(file, SERVICE)

    def scenario(self, bench: Bench) -> None:
        """Read the file, build the package, and serve the generated type to compare its type hashes."""
        bench.part(PART)
        bench.start()
        bench.wait_until(lambda e: report_of(e.main, "found") is not None, BEGINNING)
        bench.wait_until(lambda e: report_of(e.main) is not None, BUILDING)
        if bench.await_endpoint("service", SERVICE):
            _, type_name = bench.reference.only("service")
            bench.compare_type(SERVICE, type_name)
        bench.stop()

    def _holders(self, evidence: Evidence) -> list[tuple[PackageReport, Interface]]:
        report = package_mistakes.build_report(evidence.main)
        packages = report.packages if report is not None else ()
        return [(p, i) for p in packages for i in p.interfaces if i.file.rpartition("/")[2] == self._file]

    def _texts(self, evidence: Evidence) -> list[tuple[str, str]]:
        """Return the path and the text of each file with the name that the exercise asks for.

        A file is left out if the report on the workspace does not contain its text.
        """
        return [(file.file, file.text) for _, file in self._holders(evidence) if file.text is not None]

    def has_the_fields(self, evidence: Evidence) -> Finding:
        """Decide whether the file has the reference's fields: the same types and names in the same order."""
        expected, texts = _expected(evidence), self._texts(evidence)
        right = any(_fields(text) == expected for _, text in texts) or (bool(texts) and not expected)
        if not right and not self._is_read(evidence):
            # If the report does not contain the text, the generated type shows what the file contains.
            wire = self.is_on_the_wire(evidence)
            return Finding(wire.passed, _shown(expected), wire.seen)
        seen = _shown(_fields(texts[0][1])) if texts else f"no file {self._file}"
        return Finding(right, _shown(expected), seen or "an empty file")

    def declares(self, evidence: Evidence) -> Finding:
        """Decide whether package.xml declares everything that another computer needs to build and use the package."""
        expected = f"package.xml names {' and '.join(NEEDED)}"
        package = self._most_thorough(evidence)
        if package is None:
            return Finding(False, expected, f"no package with a file {self._file}")
        names = " and ".join(_undeclared(package))
        return Finding(not names, expected, f"it does not name {names}" if names else "it does")

    def _most_thorough(self, evidence: Evidence) -> PackageReport | None:
        """Return the package with the task's file that declares most of its dependencies; None if none has the file."""
        packages = (package for package, _ in self._holders(evidence))
        return min(packages, key=lambda package: len(_undeclared(package)), default=None)

    def _is_read(self, evidence: Evidence) -> bool:
        """Return True if the report contains each file with the task's name, and its text."""
        if files := [file for _, file in self._holders(evidence)]:
            return all(file.text is not None for file in files)
        report = package_mistakes.build_report(evidence.main)
        return report is None or report.complete

    def builds(self, evidence: Evidence) -> Finding:
        """Decide whether colcon builds the package, and the build generates the interface."""
        expected = f"colcon builds a package that generates {self._file.partition('.')[0]}"
        report = report_of(evidence.main)
        if report is None:
            found = package_mistakes.build_report(evidence.main)
            seen = (
                package_mistakes.seen_of_build(found) if found is not None and found.trouble else "not built"
            )
            return Finding(False, expected, seen)
        if not report.built:
            return Finding(False, expected, package_mistakes.seen_of_build(report))
        if report.missing:
            return Finding(False, expected, f"built; no {report.missing}")
        # A generated file with the right name proves little, but a program that serves the type proves that the type
        # was generated.
        served = evidence.main.first("type", SERVICE) is not None
        return Finding(
            served, expected, "built" if served else "built, but no program can use the generated type"
        )

    def is_on_the_wire(self, evidence: Evidence) -> Finding:
        """Decide whether a node that serves the generated type has the reference's type hashes."""
        seen = evidence.main.first("type", SERVICE)
        expected = "a service of the type in the task, with its fields"
        if seen is None:
            return Finding(False, expected, "no program could serve a service of this type")
        right = bool(seen.data["same"])
        return Finding(right, expected, str(seen.data["type"]) + ("" if right else ", with other fields"))

    def _three_dashes(self, evidence: Evidence) -> Advice | None:
        """Return advice if the file does not have exactly one line of three dashes, between request and response."""
        for file, text in self._texts(evidence):
            number = len(_fields(text))
            if number == 2:
                continue
            return filled_in(_WORDS["three_dashes"], file=file, lines=number - 1)
        return None

    def _interface_fields(self, evidence: Evidence) -> Advice | None:
        """Return advice if the fields in the file differ from the reference's."""
        finding = self.has_the_fields(evidence)
        texts = self._texts(evidence)
        if finding.passed or not texts or not self._is_read(evidence) or len(_fields(texts[0][1])) != 2:
            return None
        return filled_in(_WORDS["interface_fields"], texts=texts, finding=finding)

    def _interface_in_python_package(self, evidence: Evidence) -> Advice | None:
        """Return advice if the file is in an ament_python package, which does not generate interfaces."""
        holders = self._holders(evidence)
        if (
            self.builds(evidence).passed
            or not holders
            or any(p.build_type != "ament_python" for p, _ in holders)
        ):
            return None
        return filled_in(
            _WORDS["interface_in_python_package"], holders=holders, file=self._file, package=self._package
        )

    def _member_of_group(self, evidence: Evidence) -> Advice | None:
        """Return advice if package.xml lacks the line that marks an interface package, or has it in a comment."""
        holders = self._holders(evidence)
        named = any(GROUP in package.dependencies for package, _ in holders)
        if self.builds(evidence).passed or not holders or named:
            return None
        return filled_in(_WORDS["member_of_group"], holders=holders, group=GROUP)

    def _interface_not_listed(self, evidence: Evidence) -> Advice | None:
        """Return advice if the package builds, but the build generates nothing from the file."""
        report = report_of(evidence.main)
        holders = self._holders(evidence)
        if report is None or not report.built or report.missing in ("", AMENT_PACKAGE) or not holders:
            return None
        package, file = holders[0]
        return Advice(
            f"{package.name} builds, but nothing was generated from {file.file}"
            + ("." if file.listed else ", because CMakeLists.txt does not name this file."),
            f'In CMakeLists.txt, write rosidl_generate_interfaces(${{PROJECT_NAME}} "srv/{self._file}") above '
            "ament_package().",
        )

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return (
            OWN,
            Mistake("three_dashes", self._three_dashes, certain=True),
            Mistake("interface_fields", self._interface_fields, certain=True),
            Mistake("interface_in_python_package", self._interface_in_python_package, certain=True),
            Mistake("member_of_group", self._member_of_group, certain=True),
            Mistake("interface_not_listed", self._interface_not_listed, certain=True),
            *package_mistakes.BUILD,
            *CRASHES,
            *OTHER_CRASHES,
        )


def _fields(text: str) -> list[Fields]:
    """Return the fields in each section of an interface file, without comments, constants and default values.

    Only a line that is exactly ``---`` begins a new section, as in ``rosidl_adapter/parser.py``.
    """
    sections: list[Fields] = [[]]
    for line in text.splitlines():
        bare = line.partition("#")[0].strip()
        if line == "---":
            sections.append([])
        elif found := re2.fullmatch(r"(?P<type>\S+)\s+(?P<name>\w+)(?P<rest>(?:\s+.*)?)", bare):
            if not found["rest"].strip().startswith("="):
                sections[-1].append((found["type"], found["name"]))
        elif bare and "=" not in bare:
            sections[-1].append((bare, ""))
    return sections


def _undeclared(package: PackageReport) -> list[str]:
    """Return the dependencies that an interface package needs but does not declare."""
    return [name for name in NEEDED if name not in package.dependencies]


def _expected(evidence: Evidence) -> list[Fields]:
    """Return the reference's fields; empty while the reference is being recorded."""
    if not evidence.reference.parts:
        return []
    seen = evidence.reference.part(PART).first("type")
    sides: Mapping[str, Mapping[str, str]] = seen.data["fields"] if seen is not None else {}
    return [[(kind, name) for name, kind in sides[side].items()] for side in ("request", "response")]


def _shown(sections: list[Fields]) -> str:
    texts = [", ".join(f"{kind} {name}".strip() for kind, name in section) for section in sections]
    return " --- ".join(text or "(nothing)" for text in texts)
