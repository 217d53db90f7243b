"""The rows of ``gradebook_layouts.toml``: what learning management systems (LMS) take back."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass, field
from pathlib import Path

import msgspec


@dataclass(frozen=True)
class GradebookLayout:
    """The files that one LMS takes back. ``gradebook_layouts.toml`` describes the attributes."""

    purpose: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)
    points: str = "{name}"
    possible: str = ""
    excused: str = ""
    end: Mapping[str, str] = field(default_factory=dict)
    pages: str = ""
    within: str = ""
    late_twice: str = ""


LAYOUTS = msgspec.toml.decode(
    Path(__file__).with_suffix(".toml").read_bytes(), type=dict[str, GradebookLayout]
)
"""The layouts by system."""
