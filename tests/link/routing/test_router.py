"""The routing rules, one by one: who gets a frame, who does not, and what never happens to a frame on the way."""

from __future__ import annotations

from collections.abc import Hashable

import pytest
from fastcrc.crc16 import mcrf4xx
from hypothesis import given
from hypothesis import strategies as st

from dialects import codec
from dialects.messages import (
    Attitude,
    CommandLong,
    ManualControl,
    Message,
    ParamRequestRead,
    RadioStatus,
    SystemTime,
)
from link.routing.router import MAX_RECENT_UNTRACKED, REDUNDANCY_WINDOW, Router
from tests.link.frames import demand, frame, heartbeat, version_1

SERIAL, UDP, OTHER = 0, 1, 2
GCS, GCS_2 = ("10.0.0.1", 5001), ("10.0.0.2", 5002)
BROADCAST = Attitude(1, 0.5, 0, 0, 0, 0, 1)


def router(**options: object) -> Router:
    """A vehicle on a serial port; ground stations on UDP; another fixed link."""
    return Router([(True, "tty"), (False, None), (False, "out")], **options)  # type: ignore[arg-type]


class Rig:
    """The router with a vehicle (1/1) on serial and a ground station (255/190) on UDP."""

    def __init__(self, **options: object) -> None:
        self.router = router(**options)
        self.send(SERIAL, heartbeat(0, 1, 1))
        self.send(UDP, heartbeat(0))

    def send(
        self, port: int, data: bytes, address: Hashable | None = None, now: float = 1.0
    ) -> dict[tuple[int, Hashable], bytes]:
        where = address or {SERIAL: "tty", UDP: GCS, OTHER: "out"}[port]
        found = self.router.receive(port, [(data, where)], now)
        return {(each.link, each.address): b"".join(each.frames) for each in found}


def command(target: int, component: int, sequence: int = 1) -> bytes:
    return frame(CommandLong(target, component, 400, 0, 1, 0, 0, 0, 0, 0, 0), sequence)


def unknown(sequence: int = 1, message_id: int = 45999, system: int = 1, component: int = 1) -> bytes:
    """A frame of an id outside every dialect here: its checksum cannot be known."""
    body = bytes([7, 0, 0, sequence, system, component]) + message_id.to_bytes(3, "little") + b"payload"
    return b"\xfd" + body + mcrf4xx(body + b"\x77").to_bytes(2, "little")


# ---- who gets it ----


def test_a_broadcast_goes_to_all_others_and_not_back() -> None:
    rig = Rig()
    data = frame(BROADCAST, 1, 1, 1)
    assert rig.send(SERIAL, data) == {(UDP, GCS): data, (OTHER, "out"): data}


def test_a_connection_that_has_not_spoken_gets_broadcasts_only() -> None:
    """Two bridges that are joined would each wait for the first frame of the other."""
    bridge = Router([(False, None), (True, None)])
    assert bridge.receive(1, [(b"", "rover1")], 1.0) == []
    [delivery] = bridge.receive(0, [(heartbeat(0), GCS)], 1.1)
    assert (delivery.link, delivery.address, delivery.frames) == (1, "rover1", [heartbeat(0)])
    assert bridge.receive(0, [(command(1, 1), GCS)], 1.2) == []
    bridge.table.handle_disconnect(1, "rover1")
    assert bridge.receive(0, [(heartbeat(2), GCS)], 2.1) == []


def test_a_command_goes_only_where_its_system_was_heard() -> None:
    rig = Rig()
    data = command(1, 1)
    assert rig.send(UDP, data) == {(SERIAL, "tty"): data}


@pytest.mark.parametrize(
    ("target", "component", "where"),
    [
        (1, 1, {SERIAL}),
        (1, 0, {SERIAL, OTHER}),
        (1, 154, {OTHER}),
        (1, 99, {SERIAL, OTHER}),  # a component that nobody has heard: its system will know
        (2, 1, set()),
        (0, 0, {SERIAL, OTHER}),
    ],
)
def test_the_table_of_targets(target: int, component: int, where: set[int]) -> None:
    rig = Rig()
    rig.send(OTHER, heartbeat(0, 1, 154))
    assert {port for port, _ in rig.send(UDP, command(target, component))} == where


def test_two_stations_on_one_port_hear_each_other_and_vehicle() -> None:
    rig = Rig()
    data = heartbeat(1, system=254)
    assert (UDP, GCS) in rig.send(UDP, data, GCS_2)
    telemetry = frame(BROADCAST, 1, 1, 1)
    assert {address for _, address in rig.send(SERIAL, telemetry)} == {GCS, GCS_2, "out"}


def test_manual_control_has_a_target_of_another_name() -> None:
    rig = Rig()
    assert set(rig.send(UDP, demand(1, target=1))) == {(SERIAL, "tty")}
    assert rig.send(UDP, demand(2, target=7)) == {}


def test_a_target_that_truncation_cut_off_is_everybody() -> None:
    rig = Rig()
    data = frame(ManualControl(target=0, x=0, y=0, z=0, r=0, buttons=0), 1)
    assert len(data) == 13
    assert set(rig.send(UDP, data)) == {(SERIAL, "tty"), (OTHER, "out")}


def test_version_1_has_targets_too() -> None:
    rig = Rig()
    request = ParamRequestRead(1, 1, b"X", -1)
    assert set(rig.send(UDP, version_1(request, 1))) == {(SERIAL, "tty")}
    assert rig.send(UDP, version_1(ParamRequestRead(9, 1, b"X", -1), 2)) == {}


# ---- what stays, and what passes untouched ----


@pytest.mark.parametrize("message", [RadioStatus(1, 1, 99, 1, 1, 0, 0), "signing"])
def test_radio_status_and_keys_stay_on_their_link(message: Message | str) -> None:
    rig = Rig()
    data = _setup_signing() if isinstance(message, str) else frame(message, 1, 51, 68)
    assert rig.send(SERIAL, data) == {}
    assert rig.send(UDP, data) == {}


@pytest.mark.parametrize("port", [SERIAL, UDP])
def test_a_key_is_not_forwarded_with_a_wrong_checksum_either(port: int) -> None:
    """The damage may be anywhere, and the key is in it. The link that sent it counts a checksum error."""
    rig = Rig()
    key = _setup_signing()
    damaged = key[:-1] + bytes([key[-1] ^ 1])
    follower = heartbeat(3, 1, 1) if port == SERIAL else heartbeat(3)
    passed = rig.send(port, damaged, now=1.0) | rig.send(port, follower, now=1.3)
    assert set(passed.values()) == {follower}  # the frame behind it is not lost
    errors = [report.crc_errors for report in rig.router.table.transport_reports()]
    assert errors[port] == 1


def _setup_signing() -> bytes:
    return codec.frame(256, bytes(8) + b"\x01\x01" + b"k" * 32, 1, 255, 190)


def test_unknown_ids_are_forwarded_unchanged() -> None:
    for port, system in ((SERIAL, 1), (UDP, 255)):
        rig = Rig()
        trains = (
            unknown(1, system=system),
            unknown(2, system=system) + heartbeat(3, system, 1),
            heartbeat(4, system, 1) + unknown(5, system=system) + unknown(6, system=system),
        )
        for data in trains:
            assert rig.send(port, data)[OTHER, "out"] == data
        assert rig.router.table.transport_reports()[port].unknown == 4


def test_unknown_ids_in_pieces_on_a_stream() -> None:
    rig = Rig()
    data = unknown(1) + unknown(2)
    assert rig.send(SERIAL, data[:9]) == {}
    assert rig.send(SERIAL, data[9:30])[OTHER, "out"] == unknown(1)
    assert rig.send(SERIAL, data[30:])[OTHER, "out"] == unknown(2)


def test_a_signed_frame_goes_on_with_its_signature() -> None:
    rig = Rig()
    data = _signed(1, b"s" * 13)
    assert rig.send(SERIAL, data)[UDP, GCS] == data


def _signed(sequence: int, signature: bytes) -> bytes:
    body = bytearray(heartbeat(sequence, 1, 1)[1:-2])
    body[1] = 1
    return b"\xfd" + bytes(body) + mcrf4xx(bytes(body) + b"\x32").to_bytes(2, "little") + signature


def test_damaged_frames_and_noise_stay_here() -> None:
    rig = Rig()
    damaged = bytearray(frame(BROADCAST, 1, 1, 1))
    damaged[15] ^= 0x10
    good = frame(BROADCAST, 2, 1, 1)
    assert rig.send(SERIAL, bytes(damaged) + b"noise\xfd\xfe" + good)[UDP, GCS] == good
    assert rig.router.table.transport_reports()[SERIAL].crc_errors == 1
    assert rig.router.table.transport_reports()[SERIAL].noise_bytes > 0


def test_unknown_frames_teach_no_routes() -> None:
    rig = Rig()
    rig.send(OTHER, unknown(1, system=9, component=9))
    assert rig.send(UDP, command(9, 9)) == {}
    assert [route.system for route in rig.router.table.route_reports(1.0)] == [1, 255]


@pytest.mark.parametrize("ids", [(0, 1), (0, 0)])
def test_system_0_goes_nowhere(ids: tuple[int, int]) -> None:
    assert Rig().send(SERIAL, heartbeat(1, *ids)) == {}


def test_component_0_of_a_pymavlink_script_is_a_source() -> None:
    rig = Rig()
    assert set(rig.send(UDP, heartbeat(0, 254, 0))) == set(rig.send(UDP, heartbeat(0, 253, 190))) != set()
    assert (254, 0) in [(route.system, route.component) for route in rig.router.table.route_reports(1.0)]
    assert set(rig.send(SERIAL, frame(CommandLong(254, 0, 400, 0, 1, 0, 0, 0, 0, 0, 0), 1, 1, 1))) == {(UDP, GCS)}


# ---- redundant links ----


def test_the_same_frame_over_two_links_goes_on_once() -> None:
    rig = Rig()
    data = frame(BROADCAST, 9, 1, 1)
    assert (UDP, GCS) in rig.send(SERIAL, data, now=1.0)
    assert rig.send(OTHER, data, now=1.2) == {}
    assert rig.router.duplicates == 1
    assert (UDP, GCS) in rig.send(OTHER, frame(BROADCAST, 10, 1, 1), now=1.3)
    assert rig.send(SERIAL, frame(BROADCAST, 10, 1, 1), now=1.4) == {}


def test_forged_copy_that_comes_first_does_not_block_signed_one() -> None:
    """The same frame but for the signature, over another link: only who has the key knows which one is genuine."""
    rig = Rig()
    forged, genuine = _signed(9, b"a" * 13), _signed(9, b"b" * 13)
    assert rig.send(SERIAL, forged)[UDP, GCS] == forged
    assert rig.send(OTHER, genuine)[UDP, GCS] == genuine
    assert rig.send(SERIAL, genuine) == {}


def circling(data: bytes, rounds: int, wires: int) -> int:
    """Transmissions of one frame in a ring of two bridges that `wires` cables join; it enters at a third port."""
    bridges = [Router([(False, f"cable {n}") for n in range(wires)] + [(False, None)]) for _ in range(2)]
    for bridge in bridges:
        bridge.receive(wires, [(heartbeat(0), GCS)], 1.0)
        for wire in range(wires):
            bridge.receive(wire, [(heartbeat(0, 3 + wire, 1), f"cable {wire}")], 1.0)
    waiting = [(0, wires, data)]
    sent = 0
    for step in range(rounds):
        if sent > 1000:
            break  # it multiplies
        arrived, waiting = waiting, []
        for number, port, raw in arrived:
            address = GCS if port == wires else f"cable {port}"
            for delivery in bridges[number].receive(port, [(raw, address)], 1.0 + step / 1000):
                sent += len(delivery.frames)
                waiting += [(1 - number, delivery.link, each) for each in delivery.frames if delivery.link != wires]
    return sent


@pytest.mark.parametrize("wires", [2, 3])
def test_an_unknown_frame_passes_a_ring_of_bridges_once(wires: int) -> None:
    """Its sender was never heard with a known message, so that no table knows the frame when it comes back."""
    data = unknown(5, system=77)
    assert circling(data, rounds=3, wires=wires) > 0  # it is forwarded at all
    assert circling(data, rounds=50, wires=wires) == circling(data, rounds=100, wires=wires) <= 4 * wires


def test_memory_of_untracked_frames_is_bounded_and_ends_in_time() -> None:
    rig = Rig()
    for number in range(MAX_RECENT_UNTRACKED + 50):
        message_id = 45000 + number // 250
        assert rig.send(OTHER, unknown(number % 250, message_id, system=77), now=1.0)
    assert not rig.send(
        OTHER,
        unknown((MAX_RECENT_UNTRACKED + 49) % 250, 45000 + (MAX_RECENT_UNTRACKED + 49) // 250, system=77),
        now=1.5,
    )
    assert rig.send(OTHER, unknown(7, 45999, system=77), now=2.0)
    assert rig.send(OTHER, unknown(7, 45999, system=77), now=2.0 + REDUNDANCY_WINDOW)


def test_the_same_number_long_after_is_another_frame() -> None:
    rig = Rig()
    data = frame(BROADCAST, 9, 1, 1)
    rig.send(SERIAL, data, now=1.0)
    assert rig.send(OTHER, data, now=1.0 + REDUNDANCY_WINDOW) != {}


def test_nothing_of_a_vehicle_returns_to_it_over_its_other_link() -> None:
    rig = Rig()
    rig.send(OTHER, heartbeat(1, 1, 1))
    assert set(rig.send(SERIAL, frame(BROADCAST, 2, 1, 1))) == {(UDP, GCS)}
    assert set(rig.send(UDP, command(1, 1))) == {(SERIAL, "tty"), (OTHER, "out")}


def test_a_vehicle_that_restarts_elsewhere_has_left_its_old_link() -> None:
    rig = Rig()
    rig.send(SERIAL, frame(SystemTime(0, 90_000), 1, 1, 1))
    rig.send(OTHER, frame(SystemTime(0, 1_000), 0, 1, 1))
    assert set(rig.send(UDP, command(1, 1))) == {(OTHER, "out")}


# ---- beside a host's own work ----


def test_what_is_for_the_host_alone_ends_there() -> None:
    rig = Rig(own=(1, 1))
    rig.send(OTHER, heartbeat(0, 1, 154))
    assert rig.send(UDP, command(1, 1)) == {}
    assert set(rig.send(UDP, command(1, 0, 2))) == {(OTHER, "out")}
    assert rig.send(UDP, heartbeat(3, 1, 1)) == {}


# ---- caps and ends ----


def test_a_recorder_gets_every_frame_once() -> None:
    rig = Rig()
    rig.router.captured = []
    data = [frame(BROADCAST, 1, 1, 1), unknown(2), command(9, 9)]
    for port, each in zip((SERIAL, SERIAL, UDP), data, strict=True):
        rig.send(port, each)
    assert rig.router.captured == data


# ---- anything ----

FRAMES = [
    heartbeat(1, 1, 1),
    frame(BROADCAST, 2, 1, 1),
    command(1, 1),
    command(3, 1),
    unknown(3),
    _signed(4, b"s" * 13),
]
PIECES = st.one_of(st.binary(max_size=60), st.sampled_from(FRAMES), st.sampled_from([each[:9] for each in FRAMES]))


@given(st.lists(st.tuples(st.integers(0, 2), st.sampled_from(["tty", "out", "a", "b"]), PIECES), max_size=60))
def test_byte_soup_never_raises_and_adds_nothing_to_the_output(soup: list[tuple[int, str, bytes]]) -> None:
    # Two senders of one frame are not redundant links here: time passes in steps that are longer than that.
    router = Router([(True, "tty"), (False, None), (False, "out")])
    taken: dict[str, bytes] = {}
    for step, (port, address, data) in enumerate(soup):
        now = step * 2.0
        taken[f"{port}{address}"] = taken.get(f"{port}{address}", b"") + data
        for delivery in [*router.receive(port, [(data, address)], now), *router.tick(now + 1.0)]:
            for raw in delivery.frames:
                assert any(raw in everything for everything in taken.values())
                assert raw[0] in (0xFD, 0xFE)
    data = frame(BROADCAST, 9, 77, 7)  # a sender that no soup has
    assert {each.link for each in router.receive(SERIAL, [(data + data, "tty")], 1e4) if data in each.frames} >= {OTHER}


def test_a_link_may_be_added_and_removed_while_frames_pass() -> None:
    rig = Rig()
    rig.router.table.add_link(7, stream=False, fixed="new")
    data = frame(BROADCAST, 1, 1, 1)
    assert rig.send(SERIAL, data) == {(UDP, GCS): data, (OTHER, "out"): data, (7, "new"): data}
    rig.router.receive(7, [(heartbeat(0, 9, 1), "new")], 1.0)
    to_it = command(9, 1)
    assert rig.send(UDP, to_it) == {(7, "new"): to_it}
    rig.router.table.remove_link(7)
    data = frame(BROADCAST, 2, 1, 1)
    assert rig.send(SERIAL, data) == {(UDP, GCS): data, (OTHER, "out"): data}
    assert rig.send(UDP, command(9, 1, 2)) == {}
    assert {report.system for report in rig.router.table.route_reports(2.0)} == {1, 255}
