"""The stop matrix of tests/test_stops.py with a rover that ignores what is not signed, and what the station tells.

`MAVHELM_SIGNED=1 pytest tests/e2e/test_stop_matrix.py` is the same with the real programs.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from groundstation.intents.driving import ClearEmergencyStop, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import Arm, Disarm, SetMode
from groundstation.snapshot.signing import SigningState, SigningView
from link.core import SigningCounts
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from tests.link.signing.signed import DRIVER, SIGNED_ONLY, keep
from tests.test_stops import NEUTRAL_WITHIN, Drive
from vehicle.safety.states import SafetyState

AT_ONCE = {"falls": 0.05, "neutral": 0.5}
LOCKED = {"falls": 0.05, "neutral": 0.05}
OTHER = SigningKey("other", SigningRole.SET_UP, bytes(range(32)))
WATCHED = SigningPolicy(unsigned=SigningRole.WATCH, open_stops=True)


def signed_drive(key: SigningKey | None = DRIVER, policy: SigningPolicy = SIGNED_ONLY) -> Drive:
    """Return a rover with the key DRIVER, and a station with `key` or without one."""
    drive = Drive()
    sign(drive, key, policy)
    return drive


def sign(drive: Drive, key: SigningKey | None = DRIVER, policy: SigningPolicy = SIGNED_ONLY) -> None:
    """Give the rover of a drive the key DRIVER, and the station `key`."""
    now = drive.world.now
    drive.world.far.channel.guard = SigningGuard(keep(DRIVER, now=now), policy, 0)
    if key is not None:
        drive.world.near.channel.guard = SigningGuard(keep(key, now=now), SIGNED_ONLY, 0)


def signing_of(drive: Drive) -> SigningView:
    signing = drive.station.snapshot(drive.world.now, 0).signing
    assert signing is not None
    return signing


def release_key(drive: Drive) -> None:
    drive.held = None


def freeze_screen(drive: Drive) -> None:
    drive.screen_lives = False


def freeze_station(drive: Drive) -> None:
    drive.world.near.frozen = True


def press_stop(drive: Drive) -> None:
    drive.held = None
    drive.tell(Stop())


STOPS: dict[str, tuple[Callable[[Drive], None], dict[str, float]]] = {
    "key released": (release_key, {}),
    "stop key": (press_stop, AT_ONCE),
    "screen frozen": (freeze_screen, {}),
    "gate closed": (lambda drive: drive.tell(SetKeyGate(False, "help is open")), AT_ONCE),
    "station frozen": (freeze_station, {}),
    "link cut": (lambda drive: drive.world.cut(), {}),
    "disarmed": (lambda drive: drive.tell(Disarm()), LOCKED),
    "emergency stop": (lambda drive: drive.tell(EmergencyStop()), LOCKED),
}


def recover(drive: Drive) -> None:
    """Undo all of them, as a driver would."""
    drive.held, drive.screen_lives, drive.world.near.frozen = None, True, False
    drive.world.cut(False)
    drive.tell(SetKeyGate(True))
    drive.run(1.5)
    if drive.rover.state is SafetyState.ESTOP:
        drive.tell(ClearEmergencyStop(held=1.0))
    drive.tell(SetMode("MANUAL"))
    drive.run(0.5)


def test_every_stop_stops_a_rover_that_ignores_unsigned_frames() -> None:
    """One rover through all of them: after each it drives again, signed."""
    drive = signed_drive()
    for stop, bounds in STOPS.values():
        drive.get_going()
        stop(drive)
        drive.assert_stops(drive.world.now, **bounds, stays=2.0)
        recover(drive)
    report = drive.world.far.channel.report()
    assert report.refused == SigningCounts(), "nothing of the driver was refused"
    assert signing_of(drive).state is SigningState.ON


def test_station_that_loses_its_key_while_driving_stops_rover() -> None:
    drive = signed_drive()
    drive.get_going()
    drive.world.near.channel.guard = None
    drive.assert_stops(drive.world.now, neutral=NEUTRAL_WITHIN)


@pytest.mark.parametrize(
    ("key", "policy", "state", "words"),
    [
        (DRIVER, SIGNED_ONLY, SigningState.ON, "our key is laptop ("),
        (None, WATCHED, SigningState.NO_KEY, "mavhelm sign install"),
        (OTHER, SIGNED_ONLY, SigningState.REJECTED, "wrong key from system 1; compare the fingerprints"),
    ],
)
def test_the_station_tells_the_state_of_signing(
    key: SigningKey | None, policy: SigningPolicy, state: SigningState, words: str
) -> None:
    drive = signed_drive(key, policy)
    drive.run(3.0)
    signing = signing_of(drive)
    assert signing.state is state
    assert words in signing.text


def test_vehicle_that_refuses_an_unsigned_request_needs_signing() -> None:
    """It has no key to sign with yet, so only its refusal shows it."""
    drive = Drive()
    drive.world.far.channel.guard = SigningGuard(keep(now=drive.world.now), WATCHED, 0)
    drive.run(2.0)
    assert signing_of(drive).state is SigningState.OFF
    drive.tell(Arm(held=1.0))
    drive.run(2.0)
    assert drive.rover.state is not SafetyState.ARMED
    assert signing_of(drive).state is SigningState.REQUIRED
    assert signing_of(drive).alarm
