"""A port that the watchdog of a killed program still has for a moment."""

from __future__ import annotations

import contextlib

import pytest

from groundstation.verbs.session.running import PORT_WITHIN, run_when_port_free
from link.transport.transport import LinkError, PortInUseError
from tests.world_loop import WorldLoop


def attempts_until(free_at: float, error: type[LinkError] = PortInUseError) -> tuple[int, float]:
    """Return the exit code of a verb whose port is free at a time, and when it ended."""

    now = 0.0

    def advance() -> None:
        nonlocal now
        now += 0.01

    async def attempt() -> int:
        if now < free_at:
            raise error("udpin:0.0.0.0:14550: port 14550 is in use")
        return 0

    with contextlib.closing(WorldLoop(lambda: now, advance)) as loop:
        return loop.run_until_complete(run_when_port_free(attempt)), now


def test_a_verb_waits_for_a_port_that_is_given_back() -> None:
    code, ended = attempts_until(1.3)
    assert code == 0
    assert ended == pytest.approx(1.3, abs=0.11)


def test_a_port_of_another_program_is_an_error_after_two_seconds() -> None:
    with pytest.raises(PortInUseError, match="14550 is in use"):
        attempts_until(PORT_WITHIN + 1)


def test_another_error_of_a_link_is_told_at_once() -> None:
    with pytest.raises(LinkError):
        attempts_until(0.05, LinkError)
