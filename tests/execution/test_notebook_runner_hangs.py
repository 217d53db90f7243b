"""What has hung once is not waited for at full length again, and nobody is blamed for a neighbour's hanging."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.boxes.run_limits import Ended, Limits
from autograder.execution.executed_cells import Cell, CellCheck
from autograder.execution.notebook_runner import _Run
from tests.boxes.fork_servers import SilentJudge

if TYPE_CHECKING:
    from autograder.boxes.run_limits import Left

LIMITS = Limits(cell_seconds=120, check_margin=10)
CHECK = CellCheck("lab.one", "One", 10, 10, limit=120)
TALKER = Cell("class Talker:\n    def run(self):\n        while True: pass", own=True)
LISTENER = Cell("class Listener: pass", own=True)
SHOWN, SHOWN_AGAIN = Cell("Talker().run()"), Cell("t = Talker()\nt.run()")


class Kernel:
    """Stops each cell that uses one of these names, at once."""

    alive = True

    def __init__(self, *hanging: str) -> None:
        self._hanging = hanging

    def execute(self, cell: int, source: str, left: Left) -> Ended:
        del cell, left
        is_use = not source.startswith("class") and any(name in source for name in self._hanging)
        return Ended.TIMED_OUT if is_use else Ended.DONE


def seconds(cells: list[Cell], *hanging: str) -> tuple[list[float], str]:
    """What each cell was given, and what the last check is told."""
    run = _Run(cells, LIMITS)
    run.all_cells(Kernel(*hanging), SilentJudge())  # type: ignore[arg-type]
    verdicts = list(run.result(0, 0).verdicts.values())
    return run._allowed, verdicts[-1].diagnosis.text if verdicts and verdicts[-1].diagnosis else ""


def check(name: str) -> Cell:
    return Cell(f'check("lab.one", {name})', check=CHECK)


def test_a_class_that_hung_is_waited_for_once() -> None:
    given, said = seconds([TALKER, SHOWN, SHOWN_AGAIN, SHOWN, check("Talker")], "Talker")
    assert given == [120, 120, 10, 10, 40]
    assert "`Talker` did not end in the cell that begins with “Talker().run()”" in said


def test_other_classes_have_all_their_time() -> None:
    cells = [TALKER, LISTENER, SHOWN, Cell("Listener()"), check("Listener"), check("Talker")]
    assert seconds(cells, "Talker")[0] == [120, 120, 120, 120, 130, 40]


def test_where_two_could_hang_nobody_is_blamed() -> None:
    cells = [TALKER, LISTENER, Cell("both(Talker, Listener)"), check("Listener"), check("Talker")]
    assert seconds(cells, "both")[0] == [120, 120, 120, 130, 130]


def test_a_cell_of_the_students_own_blames_nobody() -> None:
    own = Cell("node = Talker()\nwhile True: pass", own=True)
    assert seconds([TALKER, own, check("Talker")], "while")[0] == [120, 120, 130]


def test_a_terminal_has_twice_as_long_since_it_may_build() -> None:
    cells = [Cell("%%bash --no-raise-error\ncolcon build"), Cell("x = 'colcon build'"), Cell("  %%sh\nls")]
    assert seconds(cells)[0] == [240, 120, 240]


def test_a_cell_that_is_no_python_blames_nobody() -> None:
    cells = [Cell("%%writefile talker.py\nclass Talker: pass", own=True), TALKER, Cell("%%bash\nTalker")]
    assert seconds([*cells, check("Talker")], "Talker")[0][:3] == [120, 120, 240]


def test_a_name_in_a_comment_a_string_or_an_attribute_is_not_used() -> None:
    mentions = Cell('# Talker hangs\nprint(\'Talker\', """\nTalker\n""")\nnode.Talker = 1', own=True)
    given, _ = seconds([TALKER, SHOWN, mentions], "Talker()")
    assert given == [120, 120, 120]


def test_a_name_behind_a_string_without_an_end_is_not_lost_to_the_next_line() -> None:
    given, _ = seconds([TALKER, SHOWN, Cell("print('it\nTalker()", own=True)], "Talker()")
    assert given == [120, 120, 10]
