"""Tables that no browser opens are shown as they were typed, and those that students write stay."""

from __future__ import annotations

import pytest

from autograder.grading.returning.browser_memory import positions_in_tables
from autograder.grading.returning.sanitize import clean, harmless_markdown


def table(*rows: str) -> str:
    return "<table>" + "".join(f"<tr>{row}</tr>" for row in rows) + "</table>"


@pytest.mark.parametrize(
    "text",
    [
        table("<td colspan=1000>" * 2_500),
        table("<td colspan=1000>" * 60, *["<td>"] * 3_000),
        table(
            '<th class="k" colspan="+1000">' * 10,
            *["<td colspan=' 1000'>"] * 1_000,
            "<td colspan=1000>" * 300,
        ),
        table("<td rowspan=65534 colspan=500>" * 40, *["<td>"] * 2_000),
        table("<td>" * 2_500, *["<td>"] * 2_500),
        "".join(table(table("<td>" * 30)) for _ in range(3)) + table("<td>" * 2_000, *["<td>"] * 2_000),
        f"<table><tr><td>{table(*['<td colspan=900>x'] * 900)}</td></tr></table>",
    ],
)
def test_a_table_of_too_many_places_is_text(text: str) -> None:
    assert len(text) < 50_000
    assert positions_in_tables(clean(text)) <= 50_000
    assert positions_in_tables(harmless_markdown(f"<div>{text}</div>")) <= 50_000


def test_tables_as_students_write_them_stay() -> None:
    plain = "| name | value |\n| --- | ---: |\n" + "| a | 1 |\n" * 500
    assert harmless_markdown(plain) == plain
    spans = table("<td colspan=3>head", "<td rowspan=2>a<td>b<td>c", "<td>d<td>e")
    assert 'colspan="3"' in clean(spans)
    assert positions_in_tables(clean(spans)) == 3 * 4
    large = table(*["<td>x" * 20] * 300)
    assert clean(large).startswith("<table>")
    nested = clean(f"<table><tr><td>{table('<td>a<td>b')}<td>c</table>")
    assert positions_in_tables(nested) == 2 + 2
