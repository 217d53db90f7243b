"""What is demanded of a batch of attacks, each demand with a sentence for whoever sees it fail."""

from __future__ import annotations

import os
import re
import site
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING

from attack_class import HONEST, MARK

from autograder import course

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from attack_bank import Attack
    from attack_class import Graded, Traps

LEAK = "LEAK:"
"""What an attack prints when it has got what it came for."""


def objections(attack: Attack, graded: Graded, traps: Traps) -> list[str]:
    """What an attack has brought about that it should not have; empty where it was defeated."""
    about = graded.written_about(attack.name)
    return [
        *_unearned(attack, graded),
        *(f"its output says {line.strip()[:200]!r}" for line in _leaks(about)),
        *(
            f"the secret of the {name} stands in its pages"
            for name, text in traps.secrets.items()
            if text in about
        ),
        *([f"it has never said {attack.says!r}"] if attack.says and not _has_said(attack, graded) else []),
        *(
            ["the grader keeps a secret that it has found"]
            if attack.says and _keeps_a_leak(attack, graded)
            else []
        ),
        *(f"it reached the trap outside ({visitor})" for visitor in traps.visitors if attack.name in visitor),
        *(f"its page runs {element}" for element in _active(graded, attack.name)),
    ]


def general_objections(chosen: Iterable[Attack], graded: Graded, traps: Traps) -> list[str]:
    """What went wrong about the batch as a whole."""
    turned_away = {attack.name for attack in chosen if attack.refused}
    named = {
        Path(word).parents[1].name for word in re.findall(r"^refused +(\S+): ", graded.output, re.MULTILINE)
    }
    changed = sorted(
        name for name in graded.before | graded.after if graded.before.get(name) != graded.after.get(name)
    )
    right_code = 2 if turned_away else 0
    return [
        *([f"autograder grade ended with code {graded.exit_code}"] if graded.exit_code != right_code else []),
        *([f"refused were {sorted(named)}, not {sorted(turned_away)}"] if named != turned_away else []),
        *(line for line in graded.output.splitlines() if line.startswith("problem")),
        *(f"{student} has {graded.points(student)}, not {points}: {list(graded.rows.get(student, {}).values())}"
          for student, points in HONEST.items() if graded.points(student) != points),
        *(f"{name} was changed" for name in changed),
        *(f"what is planted as {name} came out" for name in _came_out(graded, traps)),
        *(f"{name} was left behind" for name in traces()),
        *(f"a datagram came out: {data[:50]!r}" for data in traps.datagrams() if traps.mark.encode() in data),
        *(f"the trap outside was reached: {visitor}" for visitor in traps.visitors),
        *(f"a process lives on: {process}" for process in processes_left(graded.path, traps.mark)),
    ]  # fmt: skip


def _has_said(attack: Attack, graded: Graded) -> bool:
    return any(attack.says.encode() in made for made in graded.everything_made())


def _keeps_a_leak(attack: Attack, graded: Graded) -> bool:
    """Whether a secret stands in evidence, which pages do not show whole."""
    return any(f"{LEAK} {attack.name} ".encode() in made for made in graded.everything_made())


def _came_out(graded: Graded, traps: Traps) -> list[str]:
    secrets = {name: text.encode() for name, text in traps.planted.items()}
    return sorted(
        {name for made in graded.everything_made() for name, text in secrets.items() if text in made}
    )


def traces() -> list[str]:
    """Files with the attacks' mark in places where only an escape can have put them."""
    folders = [
        Path("/tmp"), Path("/var/tmp"), Path("/dev/shm"), Path("/run"), Path("/run/lock"), Path("/etc/cron.d"),
        Path("/etc/profile.d"), *map(Path, site.getsitepackages()), Path(course.__file__).parent / "judge",
        Path(course.__file__).parent / "exercises", Path.home(), Path.home() / ".cache",
    ]  # fmt: skip
    found = [file for folder in folders if folder.is_dir() for file in folder.glob(f"*{MARK}*")]
    return sorted(str(file) for file in found)


def processes_left(class_path: Path, mark: str) -> list[str]:
    """Processes of a submission, or of the grader's, that still live."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        try:
            words = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            name = (entry / "comm").read_text()
        except OSError:
            continue
        if mark in words + name or str(class_path) in words:
            found.append(f"{entry.name} {words[:100]}")
    return found


def _unearned(attack: Attack, graded: Graded) -> Iterator[str]:
    everything = graded.rows.get(attack.name, {})
    rows = {exercise: row for exercise, row in everything.items() if row["assignment"] == attack.assignment}
    if not rows:
        yield "it has no row in the table of grades"
        return
    for exercise, row in rows.items():
        earned = attack.earned.get(exercise, 0.0)
        if row["state"] not in ("passed", "failed"):
            yield f"{exercise} is {row['state']}: {row['reason']}"
        elif float(row["score"]) > earned or (float(row["score"]) < earned and not attack.at_most):
            yield f"{exercise} has {row['score']} points, and {earned:g} are earned ({row['diagnosis']})"


def _leaks(about: str) -> list[str]:
    # The source of the attack's own cells is in its pages, too: there the word stands in quotation marks.
    return [
        found for found in re.findall(rf"^[^'\"\n]*{LEAK}[^\n]*", about, re.MULTILINE) if '"LEAK' not in found
    ]


class _Active(HTMLParser):
    """Finds what a browser would execute, as far as it carries the attacks' mark."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._in_script = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._in_script = tag in ("script", "style")
        for name, value in attrs:
            dangerous = name.startswith("on") or name in (
                "srcdoc",
                "src",
                "href",
                "action",
                "data",
                "formaction",
            )
            if dangerous and value and MARK in value:
                self.found.append(f"<{tag} {name}={value[:60]!r}>")

    def handle_endtag(self, tag: str) -> None:
        self._in_script = False

    def handle_data(self, data: str) -> None:
        if self._in_script and MARK in data:
            self.found.append(data[:60])


def _active(graded: Graded, student: str) -> list[str]:
    found = []
    for page in (graded.path / "feedback" / student).rglob("*.html"):
        reader = _Active()
        reader.feed(page.read_text(errors="replace"))
        found += reader.found
    return found
