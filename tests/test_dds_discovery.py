"""Domains are picked so that nobody hears a stranger, whoever picks at the same moment."""

from __future__ import annotations

import socket
import subprocess
import sys

import pytest

from autograder.dds_discovery import NoFreeDomainError, claim_free_domain, domain_from_environment

CANDIDATES = range(215, 225)
"""Nobody picks one of these, and their ports are above those that Linux gives to outgoing connections."""

CLAIM_AND_HOLD = """
import sys
from autograder.dds_discovery import claim_free_domain
claim = claim_free_domain(range(215, 225))
print(claim.domain, flush=True)
sys.stdin.read()
"""


def test_a_claimed_domain_is_not_given_twice() -> None:
    first = claim_free_domain(CANDIDATES)
    second = claim_free_domain(CANDIDATES)
    try:
        assert first.domain != second.domain
        with pytest.raises(NoFreeDomainError, match="ROS_DOMAIN_ID"):
            claim_free_domain([first.domain, second.domain])
    finally:
        first.release()
        second.release()


def test_a_released_domain_is_free_again() -> None:
    claim = claim_free_domain(CANDIDATES)
    claim.release()
    again = claim_free_domain([claim.domain])
    again.release()
    assert again.domain == claim.domain


def test_processes_that_pick_at_once_get_different_domains() -> None:
    pickers = [
        subprocess.Popen(
            [sys.executable, "-c", CLAIM_AND_HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        for _ in range(3)
    ]
    try:
        domains = [int(picker.stdout.readline()) for picker in pickers if picker.stdout]
        assert len(set(domains)) == len(pickers)
    finally:
        for picker in pickers:
            picker.communicate()


@pytest.mark.parametrize("offset", [0, 10, 24], ids=["discovery", "first participant", "eighth participant"])
def test_a_domain_on_which_somebody_is_already_is_passed_over(offset: int) -> None:
    claim = claim_free_domain(CANDIDATES)
    claim.release()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as participant:
        participant.bind(("0.0.0.0", 7400 + 250 * claim.domain + offset))
        with pytest.raises(NoFreeDomainError):
            claim_free_domain([claim.domain])


@pytest.mark.parametrize(("text", "domain"), [(None, None), ("", None), ("0", 0), (" 42 ", 42), ("232", 232)])
def test_the_environment_names_the_domain(
    text: str | None, domain: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    if text is None:
        monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    else:
        monkeypatch.setenv("ROS_DOMAIN_ID", text)
    assert domain_from_environment() == domain


@pytest.mark.parametrize("text", ["-1", "233", "seven", "4.2"])
def test_an_impossible_domain_is_named_as_such(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(ValueError, match=f"ROS_DOMAIN_ID is '{text}'.*0 to 232"):
        domain_from_environment()
