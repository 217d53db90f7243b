"""A bench with a program as its subject."""

from __future__ import annotations

import contextlib
import sys
from random import Random
from typing import TYPE_CHECKING

import pytest

from autograder.judge.bench.bench import TestBench
from autograder.judge.serving import domain
from autograder.judge.subjects.command_subject import CommandSubject
from autograder.kit.model import Pace

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager
    from pathlib import Path

    from autograder.kit.evidence import Reference

    BenchOf = Callable[[str, Reference], AbstractContextManager[TestBench]]


@pytest.fixture
def bench_of(tmp_path: Path) -> BenchOf:
    """Makes a bench, looking in real time, for a program of this text; leaving it closes it."""

    @contextlib.contextmanager
    def opened(text: str, reference: Reference) -> Iterator[TestBench]:
        program = tmp_path / "program.py"
        program.write_text(text)
        with domain.lease() as domain_id:
            subject = CommandSubject([sys.executable, str(program)])
            subject.begin(domain_id)
            with contextlib.closing(
                TestBench(subject, domain_id, reference, Pace.REAL_TIME, Random("a seed"))
            ) as bench:
                yield bench

    return opened
