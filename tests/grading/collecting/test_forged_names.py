"""Whatever somebody whom nobody knows calls her files, in whichever system's download, they are nobody's."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import pytest
from downloads import write_zip, zipped
from test_collect import lies, work

from autograder.grading.collecting.collect import collect
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

ROSTER = cases(__file__, "ROSTER")
PEOPLE = cases(__file__, "PEOPLE")
STYLES = cases(__file__, "STYLES")
FORGED = (*cases(__file__, "FORGED"), "z" * 1_200)
SUBMISSION = (
    "submission_{}:\n  :submitters:\n  - :name: {}\n    :email: {}\n  :created_at: 2025-04-26 17:34:00 Z\n"
)


def forge(name: str, forged: str) -> bytes | str:
    if name.endswith(".yml"):
        return SUBMISSION.format(1, "Ben Bär", "ben@uni.example")
    if name.endswith(".csv"):
        return "user_id,submitted_at,login_id\n102,2031-01-01T12:00:00Z,ben\n"
    return zipped(dict.fromkeys(FORGED[:8], forged)) if name.endswith(".zip") else forged


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("how", ["zip", "folder", "one by one"])
def test_no_name_that_somebody_chooses_makes_work_anothers(
    tiny: TinyClass, tmp_path: Path, style: str, how: str
) -> None:
    (tiny.path / "students.csv").write_text(ROSTER)
    honest, forged = work(tiny, 1), work(tiny, 9)
    for seed in range(3):
        chance = random.Random(f"{style}{how}{seed}")
        known = chance.sample(PEOPLE[:2], chance.choice([1, 2]))
        files: dict[str, bytes | str] = {f"{style.format(**one)}lab_1_2.ipynb": honest for one in known}
        hers = style.format(**PEOPLE[2])
        files |= {f"{hers}{name}": forge(name, forged) for name in chance.sample(FORGED, 5)}
        if style.startswith("assignment"):
            entries = (
                SUBMISSION.format(one["number"], one["name"], f"{one['id']}@uni.example") for one in PEOPLE
            )
            files["assignment_5_export/submission_metadata.yml"] = "".join(entries)
        folder = tmp_path / str(seed) / chance.choice(["", "around all"])
        folder.mkdir(parents=True)
        if how == "zip":
            above = "" if style.startswith(("lab-sub", "assignment")) else f"{folder.name}/"
            sources = [write_zip(folder / "s.zip", {f"{above}{name}": held for name, held in files.items()})]
        else:
            for name, held in files.items():
                if ".." not in name and len(name) < 1_000:
                    (folder / name).parent.mkdir(parents=True, exist_ok=True)
                    (folder / name).write_bytes(held if isinstance(held, bytes) else held.encode())
            sources = [folder] if how == "folder" else sorted(folder.iterdir())
        names = STYLES[style] if "{" in STYLES[style] else ""
        report = collect(
            tiny.path, sources, form=chance.choice(["", "" if names else STYLES[style]]), names=names
        )
        assert {one.student for one in report.outcomes} <= {"", *(one["id"] for one in known)}, (
            seed,
            sources,
        )
        assert all(lies(tiny, one["id"]) == honest for one in known), (seed, report.outcomes)
