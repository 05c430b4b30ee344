"""A held key confirms; nothing else does. In virtual time."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.actions import ACTIONS
from groundstation.input.hold_to_confirm import MAX_EVENTS, MIN_REPEATS, HoldToConfirm
from groundstation.input.keymap import KEYMAPS, KeyEvent, Keymap
from groundstation.intents.agents import EndPermission, PermitProposal
from groundstation.intents.driving import ClearEmergencyStop
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.intents.vehicle_intent import HOLD_TIME
from tests.groundstation.held_key import event_times

STANDARD = Keymap("standard", KEYMAPS["standard"])
R, R_REPEAT, R_RELEASE = KeyEvent("r"), KeyEvent("r", repeat=True), KeyEvent("r", release=True)

delays, gaps = st.floats(0.2, 1.05), st.floats(0.02, 0.09)


@dataclass
class Keyboard:
    """Reads with times, and the intents that came of them."""

    armed: bool = False
    arms: bool = True
    """The vehicle is armed as soon as it is confirmed."""
    hold: HoldToConfirm = field(default_factory=lambda: HoldToConfirm(STANDARD))
    intents: list[tuple[float, AnyIntent]] = field(default_factory=list)

    def read(self, at: float, *batch: KeyEvent, allowed: bool = True) -> None:
        found = self.hold.handle_read(batch, armed=self.armed, allowed=allowed, now=at)
        made = STANDARD.build_intents(found.passing, armed=self.armed, driving=False)
        confirmed = [] if found.confirmed is None else [found.confirmed]
        self.intents += [(at, intent) for intent in (*made, *confirmed)]
        if confirmed and self.arms:
            self.armed = True
        elif Disarm() in made:
            self.armed = False

    def hold_key(self, seconds: float, delay: float = 0.4, gap: float = 0.033, start: float = 0.0) -> None:
        for at in event_times(seconds, delay, gap):
            self.read(start + at, R)

    @property
    def confirmed(self) -> list[float]:
        return [at for at, intent in self.intents if isinstance(intent, (Arm, ClearEmergencyStop))]


def test_a_key_held_for_a_second_confirms_once() -> None:
    keyboard = Keyboard()
    keyboard.hold_key(30.0)
    assert len(keyboard.intents) == 1
    at, arm = keyboard.intents[0]
    assert HOLD_TIME <= at <= HOLD_TIME + 0.034
    assert isinstance(arm, Arm)
    assert arm.held == at


@given(delays, gaps)
def test_every_keyboard_confirms_soon_and_then_does_nothing_more(delay: float, gap: float) -> None:
    keyboard = Keyboard()
    keyboard.hold_key(8.0, delay, gap)
    assert len(keyboard.intents) == 1
    assert keyboard.confirmed[0] <= max(HOLD_TIME, delay + MIN_REPEATS * gap) + gap + 1e-6


@given(delays, gaps)
def test_a_held_key_does_not_disarm_when_armed_is_reported_later(delay: float, gap: float) -> None:
    keyboard = Keyboard(arms=False)
    for at in event_times(6.0, delay, gap):
        keyboard.armed = at > 2.5
        keyboard.read(at, R)
    assert len(keyboard.confirmed) == len(keyboard.intents) == 1


def test_the_first_press_after_the_release_disarms() -> None:
    keyboard = Keyboard()
    keyboard.hold_key(1.5)
    keyboard.read(1.75, R)
    assert keyboard.intents[-1] == (1.75, Disarm())


@given(delays, gaps)
def test_a_key_that_has_disarmed_and_stays_down_never_arms(delay: float, gap: float) -> None:
    keyboard = Keyboard(armed=True)
    keyboard.hold_key(20.0, delay, gap)
    assert keyboard.intents[0] == (0.0, Disarm())
    assert not keyboard.confirmed


def test_after_disarming_a_new_press_arms_again() -> None:
    keyboard = Keyboard(armed=True)
    keyboard.read(0.0, R)
    keyboard.hold_key(1.5, start=1.5)
    assert len(keyboard.confirmed) == 1


@given(st.floats(0.121, 5.0))
def test_taps_never_confirm_however_long(gap: float) -> None:
    keyboard = Keyboard()
    for number in range(60):
        keyboard.read(number * gap, R)
    assert not keyboard.intents


@given(st.floats(0.121, 0.3))
def test_frantic_taps_disarm_and_never_arm(gap: float) -> None:
    keyboard = Keyboard(armed=True)
    for number in range(60):
        keyboard.read(number * gap, R)
    assert keyboard.intents[0] == (0.0, Disarm())
    assert not keyboard.confirmed


def test_a_release_ends_it() -> None:
    keyboard = Keyboard()
    keyboard.read(0.0, R)
    for number in range(14):
        keyboard.read(0.4 + 0.033 * number, R_REPEAT)
    keyboard.read(0.9, R_RELEASE)
    assert keyboard.hold.progress(0.9) is None
    for number in range(60):
        keyboard.read(0.95 + 0.033 * number, R_REPEAT)
    assert not keyboard.intents


def test_reported_repeats_confirm_and_the_release_frees_the_key() -> None:
    keyboard = Keyboard()
    keyboard.read(0.0, R)
    for number in range(40):
        keyboard.read(0.4 + 0.033 * number, R_REPEAT)
    assert len(keyboard.confirmed) == 1
    keyboard.read(1.71, R_RELEASE)
    keyboard.read(1.72, R)
    assert keyboard.intents[-1] == (1.72, Disarm())


def test_a_press_without_repeats_never_confirms_by_itself() -> None:
    """The line may have lost the release."""
    keyboard = Keyboard()
    keyboard.read(0.0, R)
    keyboard.read(5.0)
    keyboard.read(5.0, R_RELEASE)
    assert not keyboard.intents


@pytest.mark.parametrize("other", ["e", "y", "space", "paste", "R", "i", "t", "escape"])
def test_another_key_in_between_starts_from_zero(other: str) -> None:
    keyboard = Keyboard()
    keyboard.hold_key(0.95)
    keyboard.read(0.96, KeyEvent(other))
    assert keyboard.hold.progress(0.97) is None or other == "t"
    for number in range(28):
        keyboard.read(0.98 + 0.033 * number, R)
    assert not keyboard.confirmed


def test_another_key_in_the_same_read_cancels() -> None:
    keyboard = Keyboard()
    for at in event_times(5.0):
        keyboard.read(at, R, KeyEvent("x"))
    assert not keyboard.confirmed


@pytest.mark.parametrize("run", [2, MAX_EVENTS, MAX_EVENTS + 1, 400])
def test_a_run_of_the_letter_in_one_read_is_not_a_held_key(run: int) -> None:
    keyboard = Keyboard()
    for number in range(5):
        keyboard.read(number * 0.3, *[R] * run)
    assert not keyboard.intents


def test_many_in_each_read_are_a_paste_over_a_slow_line() -> None:
    keyboard = Keyboard()
    for number in range(100):
        keyboard.read(number * 0.05, *[R] * (MAX_EVENTS + 1))
    assert not keyboard.intents


def test_a_cancelled_key_must_be_released() -> None:
    keyboard = Keyboard()
    keyboard.hold_key(0.8)
    keyboard.hold.cancel()
    assert keyboard.hold.progress(0.8) is None
    for number in range(100):
        keyboard.read(0.83 + 0.033 * number, R)
    assert not keyboard.intents
    keyboard.hold_key(1.5, start=5.0)
    assert len(keyboard.confirmed) == 1


def test_nothing_begins_or_ends_while_it_is_not_allowed() -> None:
    keyboard = Keyboard()
    for at in event_times(3.0):
        keyboard.read(at, R, allowed=False)
    assert not keyboard.intents
    keyboard.hold_key(0.9, start=5.0)
    keyboard.read(5.92, R, allowed=False)
    keyboard.hold_key(0.9, delay=0.033, start=5.95)
    assert not keyboard.intents


def test_disarming_needs_no_permission() -> None:
    keyboard = Keyboard(armed=True)
    keyboard.read(0.0, R, allowed=False)
    assert keyboard.intents == [(0.0, Disarm())]


def test_the_emergency_stop_is_released_by_its_own_key() -> None:
    keyboard = Keyboard()
    for at in event_times(3.0):
        keyboard.read(at, KeyEvent("t"))
    (only,) = keyboard.intents
    assert isinstance(only[1], ClearEmergencyStop)


def test_the_progress_fills_and_ends_by_itself() -> None:
    keyboard = Keyboard()
    keyboard.read(10.0, R)
    begun = keyboard.hold.progress(10.5)
    assert begun is not None
    assert (begun.action, begun.key) == (ACTIONS["vehicle.arm"], "r")
    assert begun.held == pytest.approx(0.5)
    assert keyboard.hold.progress(11.2) is None


def permits(
    key: str, *, subject_from: float = 0.0, also_from: float | None = None, text_at: float = 9.0
) -> list[AnyIntent]:
    """Hold a key for 3 s; a proposal comes at `subject_from`, and the key counts from `also_from` on (None: never)."""
    hold, made = HoldToConfirm(STANDARD), list[AnyIntent]()
    for at in event_times(3.0):
        batch = [KeyEvent(key)] if at < text_at else [KeyEvent(key), KeyEvent("x")]
        also = key if also_from is not None and at >= also_from else ""
        subject = 7 if at >= subject_from else 0
        found = hold.handle_read(batch, armed=True, allowed=False, now=at, subject=subject, also=[also])
        made += [] if found.confirmed is None else [found.confirmed]
    return made


def test_a_key_that_permits_counts_where_it_is_named() -> None:
    made = permits("p", also_from=0.0)
    assert {each.number for each in made if isinstance(each, PermitProposal)} == {7}
    assert len(made) > 30
    assert permits("p") == permits("r", also_from=0.0) == []


def test_a_key_held_before_the_proposal_permits_nothing() -> None:
    assert permits("p", also_from=0.0, subject_from=0.7) == []
    assert permits("p", also_from=0.7) == []


def test_another_key_ends_what_a_key_permits() -> None:
    made = permits("p", also_from=0.0, text_at=2.0)
    assert isinstance(made[-1], EndPermission)


_keys = st.sampled_from([R, R, R, R_REPEAT, R_RELEASE, KeyEvent("e"), KeyEvent("t"), KeyEvent("paste")])
_reads = st.lists(
    st.tuples(st.sampled_from([0.005, 0.033, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0]), st.lists(_keys, min_size=1, max_size=3)),
    max_size=60,
)


@given(_reads, st.integers(0, 20))
def test_whatever_is_typed_only_a_long_run_of_one_key_confirms(
    reads: list[tuple[float, list[KeyEvent]]], tail: int
) -> None:
    """Before each confirmation there are only reads of its key, over HOLD_TIME, with the repeats close together."""
    keyboard, now, history = Keyboard(arms=False), 0.0, list[tuple[float, list[KeyEvent]]]()
    for gap, batch in [*reads, *[(0.033, [R])] * tail, (0.4, [R]), *[(0.033, [R])] * tail]:
        now += gap
        history.append((now, batch))
        before = len(keyboard.confirmed)
        keyboard.read(now, *batch)
        if len(keyboard.confirmed) > before:
            assert _is_held(history)


def _is_held(history: list[tuple[float, list[KeyEvent]]]) -> bool:
    key = history[-1][1][0].key
    run: list[float] = []
    for at, batch in reversed(history):
        if any(press.key != key for press in batch):
            break
        if any(press.release for press in batch):
            if not batch[-1].release:  # the press that follows the release begins the run
                run.append(at)
            break
        run.append(at)
    close = sum(later - earlier <= 0.12 + 1e-9 for later, earlier in pairwise(run))
    return run[0] - run[-1] >= HOLD_TIME and close >= MIN_REPEATS
