"""A bench with a program as its subject, and a node of a subject's in this process."""

from __future__ import annotations

import contextlib
import sys
import threading
from random import Random
from typing import TYPE_CHECKING

import pytest
from rclpy.context import Context
from rclpy.node import Node

from autograder.judge import ros_setup
from autograder.judge.bench.bench import TestBench
from autograder.judge.subject import CommandSubject
from autograder.kit.bench import Pace

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager
    from pathlib import Path

    from rclpy.executors import Executor

    from autograder.kit.evidence import Reference

    SubjectNode = Callable[..., AbstractContextManager[Node]]
    Spun = Callable[[Executor, Node], AbstractContextManager[None]]
    BenchOf = Callable[..., AbstractContextManager[TestBench]]


@pytest.fixture
def bench_of(tmp_path: Path) -> BenchOf:
    """Makes a bench, by default looking in real time, for a program of this text; leaving it closes it."""

    @contextlib.contextmanager
    def opened(text: str, reference: Reference, pace: Pace = Pace.REAL_TIME) -> Iterator[TestBench]:
        program = tmp_path / "program.py"
        program.write_text(text)
        with ros_setup.lease_domain() as domain_id:
            subject = CommandSubject([sys.executable, str(program)])
            subject.begin(domain_id)
            with contextlib.closing(
                TestBench(subject, domain_id, reference, pace, Random("a seed"))
            ) as bench:
                yield bench

    return opened


@pytest.fixture
def subject_node() -> SubjectNode:
    """Makes the node ``/subject``, perhaps in a namespace, in its own context; leaving it takes it off the graph."""

    @contextlib.contextmanager
    def made(domain_id: int, namespace: str = "") -> Iterator[Node]:
        context = Context()
        context.init(domain_id=domain_id)
        node = Node("subject", context=context, namespace=namespace)
        try:
            yield node
        finally:
            node.destroy_node()
            context.try_shutdown()

    return made


@pytest.fixture
def spun() -> Spun:
    """Has an executor spin a node in a thread, until it is left."""

    @contextlib.contextmanager
    def spinning(executor: Executor, node: Node) -> Iterator[None]:
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        try:
            yield
        finally:
            executor.shutdown()
            thread.join()

    return spinning
