"""Times as systems and people write them, in many languages, and what is only half a time."""

from __future__ import annotations

from datetime import datetime

import pytest
from downloads import read_path

from autograder.grading.collecting.written_times import read_time
from tests.cases import cases


@pytest.mark.parametrize("text", cases(__file__, "words"))
def test_a_time_in_words_is_read_in_many_languages(text: str) -> None:
    assert read_time(text) == datetime(2025, 10, 3, 14, 5)


@pytest.mark.parametrize("text", cases(__file__, "half"))
def test_half_a_time_is_none(text: str) -> None:
    assert read_time(text) is None


@pytest.mark.parametrize(("date", "time"), cases(__file__, "brightspace"))
@pytest.mark.parametrize("between", ["/", " - "])
def test_brightspace_writes_dates_as_the_country_does_in_folders_and_in_files(
    between: str, date: str, time: str
) -> None:
    found = read_path(f"12345-67890 - Eve O'Neill - {date}{between}lab_1_2.ipynb".split("/"), "brightspace")
    assert found is not None
    assert (found.identity.name, found.file) == ("Eve O'Neill", "lab_1_2.ipynb")
    assert found.when == datetime.fromisoformat(time)
