"""Whatever somebody whom nobody knows calls her files, in whichever system's download, they are nobody's."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import pytest
from downloads import write_zip, zipped
from test_collect import lies, work

from autograder.grading.collecting.collect import collect

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

ROSTER = """\
id,first_name,last_name,email,canvas,github
ada,Ada,Lovelace,ada@uni.example,101,adagit
zoe,Zoë,Zuse,zoe@uni.example,105,zoegit
ben,Ben,Bär,ben@uni.example,102,bengit
"""
PEOPLE = (
    {"id": "ada", "name": "Ada Lovelace", "login": "lovelaceada", "number": "101"},
    {"id": "zoe", "name": "Zoë Zuse", "login": "zusezoe", "number": "105"},
    {"id": "mallory", "name": "Mallory", "login": "mallory", "number": "777"},
)
STYLES = {
    "{name}_{number}_assignsubmission_file_/": "moodle",
    "{name}_{number}_assignsubmission_file_": "moodle",
    "{login}_{number}_9{number}_": "canvas",
    "lab_1_2_{id}_attempt_2025-10-03-10-00-00_": "blackboard",
    "CS_101_22_{id}_attempt_2025-10-03-10-00-00_": "blackboard",
    "1{number}-7 - {name} - Oct 3, 2025 205 PM - ": "brightspace",
    "1{number}-7 - {name} - Oct 3, 2025 205 PM/": "brightspace",
    "lab-submissions/lab-{id}git/": "lab-submissions/lab-{github}",
    "lab-{id}git/": "lab-{github}",
    "{id}/": "",
    "assignment_5_export/submission_{number}/": "gradescope",
}
FORGED = (
    "ben/lab_1_2.ipynb",
    "Ben Bär/lab_1_2.ipynb",
    "ben.ipynb",
    "Ben Bär - lab_1_2.ipynb",
    "barben_102_9999_lab_1_2.ipynb",
    "x_ben_attempt_2031-01-01-10-00-00_lab_1_2.ipynb",
    "Ben Bär_7_assignsubmission_file_lab_1_2.ipynb",
    "1-2 - Ben Bär - Oct 4, 2031 205 PM - lab_1_2.ipynb",
    "x-submissions/x-bengit/lab_1_2.ipynb",
    "lab-1-2-bengit/lab_1_2.ipynb",
    "submission_1/lab_1_2.ipynb",
    "submission_metadata.yml",
    "assignment_1_export/submission_metadata.yml",
    "assignment_1_export/submission_1/lab_1_2.ipynb",
    "..\\ben\\lab_1_2.ipynb",
    "a\\barben_102_9999_lab_1_2.ipynb",
    "../ben/lab_1_2.ipynb",
    "z" * 1_200,
    "times.csv",
    "x.zip",
)
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
