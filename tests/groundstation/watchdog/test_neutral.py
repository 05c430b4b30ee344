"""Frames of the watchdog: demand and proof in full, numbers, times and signatures."""

from __future__ import annotations

import msgspec
from pymavlink.dialects.v10 import ardupilotmega as mavlink

from dialects import codec
from dialects.enums import Autopilot, OperatorFlag
from dialects.messages import ManualControl, Message, RoverOperatorPresence
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.watchdog.neutral import NeutralFrames
from groundstation.watchdog.report import DemandRoute
from link.protocol.framer import Framer
from link.protocol.signing_guard import SigningContext
from link.signing.keys import KeyRing
from link.signing.signature import is_signed, link_and_stamp
from tests.link.signing.signed import DRIVER, NOW, keep

ROVER = WatchdogTarget(
    system=4, component=9, name="Rover 4", autopilot=Autopilot.GENERIC, kind=10, session=77, boot_time=5000
)
WAY = SigningContext(DRIVER.name, 250, 128)


def frames(vehicle: WatchdogTarget = ROVER, way: SigningContext | None = None, sequence: int = 0) -> NeutralFrames:
    return NeutralFrames(vehicle, (252, 191), DemandRoute(0, None, sequence, way), keep(DRIVER))


def read(data: bytes) -> Message:
    ((number, system, component, _, raw),) = Framer(stream=False).feed(data, 0.0)
    assert (system, component) == (252, 191)
    return codec.decode_frame(number, raw)


def test_the_proof_is_a_demand_for_neutral_without_operator() -> None:
    assert read(frames().next_frame(1.5)) == RoverOperatorPresence(
        target_system=4, target_component=9, time_boot_ms=1500, echo_time_boot_ms=5000, session_id=77, input_count=0,
        last_input_age_ms=65535, flags=OperatorFlag.AXES | OperatorFlag.INPUT_LOST, x=0, y=32767, z=32767, r=0,
    )  # fmt: skip


def test_the_neutral_of_ardupilot_presses_no_button() -> None:
    ardurover = msgspec.structs.replace(ROVER, session=None, autopilot=Autopilot.ARDUPILOT)
    assert read(frames(ardurover).next_frame(1.5)) == ManualControl(4, 32767, 0, 0, 32767, 0)


def times(made: NeutralFrames, *nows: float) -> list[int]:
    found = []
    for now in nows:
        proof = read(made.next_frame(now))
        assert isinstance(proof, RoverOperatorPresence)
        found.append(proof.time_boot_ms)
    return found


def test_the_time_of_proofs_follows_the_clock_and_always_rises() -> None:
    assert times(frames(), 0.0, 0.0, 0.0, 2.5, 2.5, 1.0) == [1, 2, 3, 2500, 2501, 2502]


def test_the_time_of_proofs_wraps_after_49_days() -> None:
    assert times(frames(), 4_294_967.2951, 4_294_967.2951, 4_294_967.2951) == [0xFFFFFFFF, 0, 1]


def test_packet_numbers_wrap_and_leave_out_more_than_a_report() -> None:
    made = frames(sequence=214)
    assert [made.next_frame(1.0)[4] for _ in range(3)] == [255, 0, 1]


def test_frames_are_signed_with_the_stations_key_lead_and_link() -> None:
    made = frames(way=WAY)
    first, second = made.next_frame(0.0), made.next_frame(0.0)
    assert is_signed(first)
    assert [link_and_stamp(each) for each in (first, second)] == [(128, NOW + 250), (128, NOW + 251)]


def test_a_route_that_was_not_signed_stays_so() -> None:
    assert not is_signed(frames(way=None).next_frame(0.0))


def test_a_key_that_has_gone_signs_no_more() -> None:
    signing = keep(DRIVER)
    made = NeutralFrames(ROVER, (252, 191), DemandRoute(0, None, 0, WAY), signing)
    assert is_signed(made.next_frame(0.0))
    signing.set_ring(KeyRing())
    assert isinstance(read(made.next_frame(0.1)), RoverOperatorPresence)
    assert not is_signed(made.next_frame(0.1))


def test_a_watchdog_without_keys_signs_nothing() -> None:
    assert not is_signed(NeutralFrames(ROVER, (252, 191), DemandRoute(0, None, 0, WAY)).next_frame(0.0))


def test_a_proof_of_a_session_is_always_mavlink_2() -> None:
    """MAVLink 1 has no message of this number."""
    frame = NeutralFrames(ROVER, (252, 191), DemandRoute(0, None, 0, version_1=True)).next_frame(0.0)
    assert isinstance(read(frame), RoverOperatorPresence)
    assert frame[0] == 0xFD


def test_a_vehicle_of_mavlink_1_gets_neutral_in_it() -> None:
    rover = msgspec.structs.replace(ROVER, session=None)
    frame = NeutralFrames(rover, (252, 191), DemandRoute(0, None, 0, version_1=True)).next_frame(0.0)
    assert frame[0] == 0xFE
    [found] = mavlink.MAVLink(None).parse_buffer(frame) or []
    assert (found.get_type(), found.get_srcSystem()) == ("MANUAL_CONTROL", 252)
