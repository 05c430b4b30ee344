"""Property: whatever a program calls, over a link that loses frames, no wheel turns outside of a call that drives."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.groundstation.verbs.api.virtual_program import VirtualProgram

CALLS = 30
DRIVE = ("drive", "--throttle", "60", "--for", "0.6")
ANY_CALL = st.one_of(
    st.sampled_from([
        ("arm", "--wait", "5"), ("arm", "--wait", "5"), ("disarm",), ("stop",), ("estop",), ("estop", "--clear"), DRIVE,
        ("turn", "--steering=40", "--", "30"), ("mode", "MANUAL"), ("param", "set", "WP_RADIUS", "1.5"),
        ("param", "get", "FS_TIMEOUT"), ("control", "release"), ("control", "request"), ("status",),
    ]),
    st.builds(
        lambda throttle, steering, seconds: (
            "drive", "--throttle", f"{throttle}", "--steering", f"{steering}", "--for", f"{seconds}"
        ),
        st.integers(-100, 100), st.integers(1, 100), st.sampled_from([0.1, 0.5, 2.0]),
    ),
)  # fmt: skip
ANY_WAIT = st.sampled_from([60.0, 60.0, 60.0, 0.2])
"""s for which the program says that it waits: 0.2 is one that hangs."""
BETWEEN = st.sampled_from([0.0, 0.0, 0.3, 2.0])
"""s that it does something else behind a call."""


@pytest.mark.slow
@settings(
    max_examples=5,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
)
@given(
    st.lists(st.tuples(ANY_CALL, ANY_WAIT, BETWEEN), min_size=CALLS, max_size=CALLS),
    st.sampled_from([0.0, 0.1, 0.25]),
    st.integers(1, 1000),
)
def test_random_programs_turn_wheels_in_calls_that_drive_only(
    calls: list[tuple[tuple[str, ...], float, float]], loss: float, seed: int
) -> None:
    program = VirtualProgram(loss, seed)

    async def run(program: VirtualProgram) -> None:
        await program.call(("arm", "--wait", "30"))
        await program.call(DRIVE)
        assert program.driven == 1 or loss, "a program whose wheels never turn tests nothing"
        for words, waits, after in calls:
            await program.call(words, waits)
            await asyncio.sleep(after)

    program.run(run)
    assert program.strays == []
    assert not program.turning
    assert not program.motors.enabled
