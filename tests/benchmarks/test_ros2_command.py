"""The measurement of the ``ros2`` command in its shortest form: two notebooks and a talker, and nothing is missed."""

from __future__ import annotations

import os

import pytest

from benchmarks.ros2_command import measure


@pytest.mark.ros
@pytest.mark.slow
def test_no_command_misses_anything_beside_open_notebooks() -> None:
    before = dict(os.environ)
    kernels, figures = measure(2, ("summary", "exercise_1_3"))
    assert kernels == 3
    assert [len(figure.seconds) for figure in figures] == [2, 2, 2]
    assert [miss for figure in figures for miss in figure.misses] == []
    assert dict(os.environ) == before
