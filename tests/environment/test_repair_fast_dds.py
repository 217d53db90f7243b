"""Who deletes a participant waits asleep for the callback of discovery that is running, and lets it come to its end."""

from __future__ import annotations

import ctypes
import sys
import threading
from pathlib import Path

import pytest

from environment.repair_fast_dds import FOR_EVER, YEARS_68, repair, repaired

INSTALLED = Path(sys.prefix) / "lib/libfastrtps.so"
SET_LISTENER = "_ZN8eprosima7fastdds3dds17DomainParticipant12set_listenerEPNS1_25DomainParticipantListenerE"
IMPLEMENTATION, MUTEX, CONDITION, CALLBACKS = 0x48, 0x510, 0x538, 0xCE8
"""Where Fast DDS 2.14.5 keeps them, in bytes: the first in a DomainParticipant, the others in what it points at."""
CODE = b"\x90\x48\xba%b\xe9\x01\x02\x03\x04\x90\x48\xb9%b\xe9\x0a\x0b\x0c\x0d\x90"
FOUND = CODE % (FOR_EVER, FOR_EVER)


def test_both_waits_get_a_deadline_and_nothing_else_changes() -> None:
    assert repaired(b"before" + FOUND + b"after") == b"before" + CODE % (YEARS_68, YEARS_68) + b"after"


@pytest.mark.parametrize(
    "library",
    [b"", FOR_EVER, FOUND + FOUND, CODE % (YEARS_68, YEARS_68)],
    ids=["none", "else", "two", "done"],
)
def test_a_library_that_does_not_look_as_expected_is_left_alone(library: bytes) -> None:
    assert repaired(library) == library


def test_each_copy_is_repaired_once_and_stays_executable(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    copies = [tmp_path / "lib" / name for name in ("libfastrtps.so", "libfastrtps.so.2.14")]
    for copy in copies:
        copy.write_bytes(FOUND)
        copy.chmod(0o755)
    assert repair(tmp_path) == copies
    assert repair(tmp_path) == []
    assert {copy.stat().st_mode & 0o777 for copy in copies} == {0o755}
    assert repair(tmp_path / "nothing") == []


@pytest.mark.skipif(not INSTALLED.exists(), reason="a ROS that was sourced")
def test_the_installed_one_waits_until_the_callback_has_ended() -> None:
    """The library's own code on a participant that is only memory, in which one callback is said to be running."""
    system = ctypes.CDLL(None)
    set_listener = ctypes.CDLL(str(INSTALLED))[SET_LISTENER]
    set_listener.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    participant, inside = ctypes.create_string_buffer(0x1000), ctypes.create_string_buffer(0x1000)
    address = ctypes.addressof(inside)
    ctypes.c_void_p.from_buffer(participant, IMPLEMENTATION).value = address
    callbacks = ctypes.c_int.from_buffer(inside, CALLBACKS)
    mutex, condition = ctypes.c_void_p(address + MUTEX), ctypes.c_void_p(address + CONDITION)
    callbacks.value = 1
    returned: list[int] = []
    waiting = threading.Thread(
        target=lambda: returned.append(set_listener(ctypes.addressof(participant), None)), daemon=True
    )
    waiting.start()
    for _ in range(2000):  # without the repair it never waits, and this ends some time
        if _has_waited(inside):
            break
        waiting.join(0.01)
    assert _has_waited(inside)
    # Whoever waits has released the mutex, which the callback takes to say that it has ended.
    system.pthread_mutex_lock(mutex)
    callbacks.value = 0
    system.pthread_cond_broadcast(condition)
    system.pthread_mutex_unlock(mutex)
    waiting.join()
    assert returned == [0]


def _has_waited(inside: ctypes.Array[ctypes.c_char]) -> bool:
    """glibc counts in a condition variable who has begun to wait, in steps of two (nptl/pthread_cond_wait.c)."""
    return ctypes.c_uint64.from_buffer(inside, CONDITION).value >= 2
