"""What the station tells of signing, by what a real channel makes of real frames."""

from __future__ import annotations

from dialects.messages import Heartbeat
from groundstation.snapshot.signing import SigningState, SigningView
from groundstation.vehicles.fleet import Fleet
from groundstation.vehicles.probes.signing_watch import WINDOW
from groundstation.vehicles.state.message_log import MessageLog
from link.protocol.signing_guard import SigningPolicy
from link.signing.clock import TICKS
from link.signing.role import SigningRole
from tests.link.frames import frame
from tests.link.signing.signed import DRIVER, HERE, NOW, STRANGER, keep, signed, station

BEAT = Heartbeat(10, 3, 0, 0, 3, 3)
TAKES_UNSIGNED = SigningPolicy(unsigned=SigningRole.SET_UP, pinned_for=float("inf"), greets_late=True)


class Heard:
    """A station with a key that hears a vehicle; its fleet gets a report once a second."""

    def __init__(self) -> None:
        self.channel = station(keep(DRIVER), TAKES_UNSIGNED)
        self.fleet = Fleet(MessageLog(), 255, 190)
        self.now = 0.0

    def hear(self, *frames: bytes, seconds: float = 1.0) -> SigningView | None:
        """Take frames, and let time pass."""
        self.report()
        for data in frames:
            for received in self.channel.receive(data, HERE, self.now):
                contact = self.fleet.get_or_add(received, self.now)
                if contact is not None:
                    contact.state.receive(received, self.now)
        self.now += seconds
        self.report()
        return self.fleet.signing_of(self.fleet.selected, self.now)

    def report(self) -> None:
        self.fleet.observe([self.channel.report(now=self.now)], self.now)
        self.fleet.update(self.now)


def beat(stamp: int, key: object = DRIVER) -> bytes:
    return signed(BEAT, key, stamp, ids=(1, 1), sequence=stamp % 256)  # type: ignore[arg-type]


def test_nothing_is_told_before_there_is_anything() -> None:
    assert Heard().hear() is None


def test_a_signing_vehicle_is_on_and_its_refusals_are_counted() -> None:
    heard = Heard()
    assert heard.hear(beat(NOW)) == SigningView(
        SigningState.ON, f"on: both ends sign; our key is laptop ({DRIVER.fingerprint})"
    )
    forged = [beat(NOW + 2, STRANGER), frame(BEAT, system=1, component=1), beat(NOW)]
    seen = heard.hear(beat(NOW + TICKS), *forged)
    assert seen is not None
    assert (seen.state, seen.refused) == (SigningState.ON, "1 wrong key, 1 replayed, 1 not signed")
    assert not seen.well
    for second in range(2, int(WINDOW) + 3):
        seen = heard.hear(beat(NOW + second * TICKS))
    assert seen is not None
    assert seen.well


def test_a_vehicle_that_does_not_sign_is_off() -> None:
    seen = Heard().hear(frame(BEAT, system=1, component=1))
    assert seen is not None
    assert seen.state is SigningState.OFF
    assert seen.text.startswith("off: the vehicle does not sign; our key is laptop")


def test_a_wrong_key_is_rejected_and_named_without_a_vehicle() -> None:
    seen = Heard().hear(beat(NOW, STRANGER))
    assert seen is not None
    assert seen.state is SigningState.REJECTED
    assert seen.text == "rejected: 1 wrong key from system 1; compare the fingerprints of both ends"


def test_a_vehicle_that_signed_and_does_not_any_more_is_rejected() -> None:
    heard = Heard()
    heard.hear(beat(NOW))
    for _ in range(4):
        seen = heard.hear(frame(BEAT, system=1, component=1))
    assert seen is not None
    assert seen.state is SigningState.REJECTED
    assert "not signed from system 1; it must sign, as it did before" in seen.text


def test_a_recording_of_the_vehicle_is_replayed() -> None:
    heard = Heard()
    heard.hear(beat(NOW))
    for _ in range(4):
        seen = heard.hear(beat(NOW))
    assert seen is not None
    assert seen.state is SigningState.REPLAYED


def test_a_clock_that_is_behind_is_told_with_its_distance() -> None:
    seen = Heard().hear(beat(NOW - 7200 * TICKS))
    assert seen is not None
    assert seen.state is SigningState.CLOCK
    assert seen.text == "clock: that of system 1 is 2 h behind ours: set it"


def test_a_clock_that_is_ahead_is_told_and_all_is_well() -> None:
    seen = Heard().hear(beat(NOW + 3 * 86_400 * TICKS))
    assert seen is not None
    assert seen.well
    assert seen.clock == "its clock is 3 days ahead of ours; we sign with its time"
