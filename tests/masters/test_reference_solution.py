"""Reference solutions are taken out of their masters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.masters.master_errors import MasterError
from autograder.masters.solutions import reference_source

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.masters.source import Points

MASTER = """\
Text.

```{code-cell} ipython3
import math

HALF = 0.5
noise = print("a demonstration")
math.mood = "good"
```

Text.

```{code-cell} ipython3
:tags: [solution]

def double(number: int) -> int:
    '''Twice the number.'''
    ### BEGIN SOLUTION
    # TODO: return it.
    return 2 * number
    ### END SOLUTION
```

Text.

```{code-cell} ipython3
:tags: [check]

check("lab_9_1.double", double)
```

Text.

```{code-cell} ipython3
@staticmethod
def later(): ...
```
"""


def test_it_defines_the_subject_and_demonstrates_nothing(
    write_master: Callable[[str], Path], ten_points: Points, capsys: pytest.CaptureFixture[str]
) -> None:
    reference = reference_source(write_master(MASTER), "lab_9_1.double", points=ten_points)
    namespace: dict[str, object] = {}
    exec(reference.source, namespace)
    assert reference.subject == "double"
    assert namespace["double"](21) == 42  # type: ignore[operator]
    assert "math" in namespace
    assert namespace["HALF"] == 0.5
    assert "noise" not in reference.source
    assert "mood" not in reference.source
    assert "later" not in reference.source
    assert capsys.readouterr().out == ""


def test_a_changed_solution_changes_it(write_master: Callable[[str], Path], ten_points: Points) -> None:
    path = write_master(MASTER.replace("2 * number", "3 * number"))
    assert "3 * number" in reference_source(path, "lab_9_1.double", points=ten_points).source


def test_an_exercise_that_is_not_checked(write_master: Callable[[str], Path], ten_points: Points) -> None:
    with pytest.raises(MasterError, match=r"No cell checks 'lab_9_1\.triple'"):
        reference_source(write_master(MASTER), "lab_9_1.triple", points=ten_points)
