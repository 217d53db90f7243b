"""Repair Fast DDS in the ROS wheels, so that a node that ends while another one appears does not hang for ever.

Who deletes a participant waits for the callback of discovery that is just running. It waits "for ever", with
``time_point::max()`` as its deadline. As the wheels are built, this deadline is converted into time of day, where it
overflows into the past: ``pthread_cond_timedwait`` refuses it each time without releasing the mutex, the callback never
gets the mutex, and the program keeps a core busy until it is killed. On Ubuntu's Jazzy nothing is converted. Upstream:
https://github.com/eProsima/Fast-DDS/issues/6513.

The two functions that ask for such a wait get a deadline in 68 years instead. That is one number in each, and nothing
else of the library changes. A library that does not look as expected, as one of a later release may, is left alone.

Only the standard library is used: this runs during the set-up.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from environment.replacing import replace_content

if TYPE_CHECKING:
    from pathlib import Path

FOR_EVER = (2**63 - 1).to_bytes(8, "little")
"""``std::chrono::seconds::max()``."""
YEARS_68 = (2**31 - 1).to_bytes(8, "little")
"""So many seconds from now, in nanoseconds of either clock, stay below 2**63 until the year 2194."""
_JUMP = rb"\xe9.{4}"
_BOTH = re.compile(
    # set_listener(listener) and set_listener(listener, mask) of a DomainParticipant: each puts the default timeout
    # into a register (movabs into rdx and rcx) and jumps to the function that takes one.
    rb"(\x48\xba)%(number)b(%(jump)b\x90\x48\xb9)%(number)b(%(jump)b)"
    % {b"number": re.escape(FOR_EVER), b"jump": _JUMP},
    re.DOTALL,
)


def repaired(library: bytes) -> bytes:
    """Return the library with both waits limited; unchanged where they are not there exactly once."""
    if len(_BOTH.findall(library)) != 1:
        return library
    return _BOTH.sub(lambda both: YEARS_68.join(both.groups()), library)


def repair(prefix: Path) -> list[Path]:
    """Repair the libraries of the wheels that are not repaired yet, each in one step, and return them.

    Args:
        prefix: the environment, such as ``.venv``.
    """
    changed = []
    for path in sorted((prefix / "lib").glob("libfastrtps.so*")):
        before = path.read_bytes()
        after = repaired(before)
        if after != before:
            replace_content(path, after)
            changed.append(path)
    return changed
