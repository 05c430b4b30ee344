"""Exact ends of the windows of a held key that confirms or has acted: which repeats act again, and which do not."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from groundstation.input.hold_to_confirm import HoldToConfirm
from groundstation.input.keymap import KEYMAPS, KeyEvent, Keymap
from groundstation.intents.driving import ClearEmergencyStop
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm

R, T = KeyEvent("r"), KeyEvent("t")


@pytest.fixture
def hold() -> HoldToConfirm:
    return HoldToConfirm(Keymap("standard", KEYMAPS["standard"]))


def passes(hold: HoldToConfirm, at: float, *, armed: bool = True, allowed: bool = True) -> bool:
    """Read one R; return whether it may act."""
    return bool(hold.handle_read([R], armed=armed, allowed=allowed, now=at).passing)


def confirmed(
    hold: HoldToConfirm, times: Sequence[float], key: KeyEvent = R, *, armed: bool = False
) -> list[tuple[float, AnyIntent]]:
    found = []
    for at in times:
        result = hold.handle_read([key], armed=armed, allowed=True, now=at)
        if result.confirmed is not None:
            found.append((at, result.confirmed))
    return found


EXACT = (0.0, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0)
"""A press and five repeats 0.05 s apart, the last after 1 s."""


def test_a_second_with_five_repeats_confirms(hold: HoldToConfirm) -> None:
    assert confirmed(hold, EXACT) == [(1.0, Arm(held=1.0))]


def test_a_second_with_four_repeats_does_not_confirm(hold: HoldToConfirm) -> None:
    assert confirmed(hold, [at for at in EXACT if at != 0.8]) == []


def test_the_time_of_a_hold_is_from_its_press(hold: HoldToConfirm) -> None:
    ((at, arm),) = confirmed(hold, [64.0 + at for at in EXACT])
    assert isinstance(arm, Arm)
    assert (at, arm.held) == (65.0, 1.0)


def test_less_than_a_second_does_not_confirm(hold: HoldToConfirm) -> None:
    assert confirmed(hold, (0.0, 0.74, 0.79, 0.84, 0.89, 0.94, 0.99)) == []


def test_of_a_key_that_has_acted_repeats_do_not_act_again(hold: HoldToConfirm) -> None:
    assert [passes(hold, at) for at in (0.0, 0.4, 0.43, 0.46)] == [True, True, False, False]


def test_a_key_that_has_not_acted_passes_always(hold: HoldToConfirm) -> None:
    assert all(passes(hold, at, armed=False) for at in (0.0, 0.4, 0.43, 0.46))


def test_repeats_of_a_key_that_may_not_confirm_do_not_act_again(hold: HoldToConfirm) -> None:
    assert [passes(hold, at, allowed=False) for at in (0.0, 0.4, 0.43)] == [True, True, False]


def test_a_gap_of_120_ms_is_a_repeat(hold: HoldToConfirm) -> None:
    assert [passes(hold, at) for at in (0.0, 0.12)] == [True, False]
    assert passes(hold, 10.0)
    assert passes(hold, 10.125)


@pytest.mark.parametrize(
    ("gaps", "probe", "acts"),
    [
        ((0.03,) * 5, 0.115, False),
        ((0.03,) * 5, 0.125, True),
        ((0.03,) * 4, 0.24, False),
        ((0.03,) * 4, 0.26, True),
        ((0.08,) * 5, 0.19, False),
        ((0.08,) * 5, 0.21, True),
        ((0.08, *(0.03,) * 5), 0.19, False),
        ((0.03, 0.08, *(0.03,) * 5), 0.21, True),
        ((0.11,) * 5, 0.24, False),
        ((0.11,) * 5, 0.26, True),
    ],
)
def test_a_key_that_has_acted_is_held_for_its_longest_gap(
    hold: HoldToConfirm, gaps: tuple[float, ...], probe: float, acts: bool
) -> None:
    """2.5 times that, from 0.12 to 0.25 s once five repeats are known."""
    at = 0.4
    passes(hold, 0.0)
    passes(hold, at)
    for gap in gaps:
        at += gap
        assert not passes(hold, at)
    assert passes(hold, at + probe) is acts


def test_a_key_that_has_not_acted_is_held_for_250_ms(hold: HoldToConfirm) -> None:
    for at in (0.0, 0.4, 0.43, 0.46, 0.49, 0.52, 0.55):
        passes(hold, at, armed=False)
    assert hold.progress(0.79) is not None
    assert hold.progress(0.81) is None


def test_after_its_press_a_key_is_held_for_1100_ms(hold: HoldToConfirm) -> None:
    passes(hold, 0.0, armed=False)
    progress = hold.progress(1.1)
    assert progress is not None
    assert (progress.key, progress.held) == ("r", 1.0)
    assert hold.progress(1.11) is None
    passes(hold, 1.1, armed=False)
    progress = hold.progress(1.1)
    assert progress is not None
    assert progress.held == 1.0


def test_after_1100_ms_a_press_begins_anew(hold: HoldToConfirm) -> None:
    passes(hold, 0.0, armed=False)
    passes(hold, 1.11, armed=False)
    progress = hold.progress(1.11)
    assert progress is not None
    assert progress.held == 0.0


def test_events_of_one_read_count_once(hold: HoldToConfirm) -> None:
    hold.handle_read([R, R], armed=False, allowed=True, now=0.0)
    assert hold.progress(0.9) is not None


@pytest.mark.parametrize(("events", "is_text"), [(8, False), (9, True)])
def test_nine_events_of_one_read_are_text(hold: HoldToConfirm, events: int, is_text: bool) -> None:
    hold.handle_read([R] * events, armed=False, allowed=True, now=0.0)
    assert (hold.progress(0.1) is None) is is_text


def test_text_ends_a_hold(hold: HoldToConfirm) -> None:
    confirmed(hold, EXACT[:5])
    hold.handle_read([R] * 9, armed=False, allowed=True, now=0.92)
    assert confirmed(hold, EXACT[5:]) == []


def test_after_text_a_hold_begins_anew(hold: HoldToConfirm) -> None:
    hold.handle_read([R] * 9, armed=False, allowed=True, now=0.0)
    assert [at for at, _ in confirmed(hold, [0.5 + at for at in EXACT])] == [1.5]


def test_after_what_was_not_allowed_a_hold_begins_anew(hold: HoldToConfirm) -> None:
    hold.handle_read([R], armed=False, allowed=False, now=0.0)
    assert [at for at, _ in confirmed(hold, [0.5 + at for at in EXACT])] == [1.5]


def test_a_vehicle_that_is_armed_meanwhile_ends_the_hold(hold: HoldToConfirm) -> None:
    confirmed(hold, EXACT[:4])
    hold.handle_read([R], armed=True, allowed=True, now=0.9)
    assert confirmed(hold, EXACT[5:]) == []


def test_a_key_that_does_the_same_when_armed_confirms_then(hold: HoldToConfirm) -> None:
    assert confirmed(hold, EXACT, T, armed=True) == [(1.0, ClearEmergencyStop(held=1.0))]
