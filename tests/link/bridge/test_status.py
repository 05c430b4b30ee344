"""The status of the bridge: rates between two readings, counts since the start, over real transports."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator

import pytest

from link.bridge.status import BridgeStatus, StatusMeter, address_text
from link.routing.router import Router
from link.transport.transport import Transport
from link.transport.transports import open_transports
from tests.link.frames import heartbeat
from tests.ports import free_port

VEHICLE, GROUND, OTHER_GROUND = ("10.0.0.1", 5001), ("10.0.0.2", 5002), ("10.0.0.3", 5003)


class Meter:
    """A router between two UDP ports, and its meter."""

    def __init__(self, transports: list[Transport]) -> None:
        self.router = Router([(each.stream, each.fixed_address) for each in transports])
        self.meter = StatusMeter(transports, self.router)

    def hear(self, link: int, data: bytes, address: tuple[str, int], now: float) -> None:
        self.router.receive(link, [(data, address)], now)


@pytest.fixture
async def transports() -> AsyncIterator[list[Transport]]:
    opened = open_transports([f"udpin:127.0.0.1:{free_port()}", f"udpin:127.0.0.1:{free_port()}"])
    yield opened
    for each in opened:
        each.close()


async def test_rates_are_since_last_reading_and_counts_since_the_start(
    transports: list[Transport],
) -> None:
    meter = Meter(transports)
    meter.hear(1, heartbeat(0), GROUND, 10.0)
    for number in range(20):
        meter.hear(0, heartbeat(number, 1, 1), VEHICLE, 10.0)
    meter.meter.read(10.0)
    for number in range(20, 30):
        meter.hear(0, heartbeat(number, 1, 1), VEHICLE, 11.0)
    status = meter.meter.read(12.0)
    first, second = status.links
    assert (first.frames_in_per_s, first.frames_out_per_s) == (5.0, 0.0)
    assert (second.frames_in_per_s, second.frames_out_per_s) == (0.0, 5.0)
    assert (first.bytes_in_per_s, second.bytes_out_per_s) == (5.0 * len(heartbeat(0)),) * 2
    assert (first.endpoint, first.peers, first.lost, first.crc_errors) == (transports[0].endpoint.text, 1, 0, 0)
    [vehicle] = [route for route in status.routes if route.system == 1]
    assert (vehicle.component, vehicle.endpoint, vehicle.address) == (1, first.endpoint, "10.0.0.1:5001")
    assert (vehicle.silence, vehicle.frames_per_s, vehicle.lost) == (1.0, 5.0, 0)
    assert meter.meter.read(13.0).links[0].frames_in_per_s == 0.0


async def test_loss_is_share_of_the_last_second_and_lost_frames_count(transports: list[Transport]) -> None:
    meter = Meter(transports)
    for number in (0, 1, 2, 4, 5, 7):
        meter.hear(0, heartbeat(number, 1, 1), VEHICLE, 10.0)
    status = meter.meter.read(11.0)
    assert (status.links[0].lost, status.links[0].loss) == (2, 0.25)
    meter.hear(0, heartbeat(8, 1, 1), VEHICLE, 11.5)
    status = meter.meter.read(12.0)
    assert (status.links[0].lost, status.links[0].loss) == (2, 0.0)
    assert [route.lost for route in status.routes] == [2]


async def test_damage_repeats_and_problems_are_shown(transports: list[Transport]) -> None:
    meter = Meter(transports)
    meter.hear(0, heartbeat(0, 1, 1), VEHICLE, 10.0)
    damaged = bytearray(heartbeat(1, 1, 1))
    damaged[-1] ^= 1
    meter.hear(0, bytes(damaged), VEHICLE, 10.0)
    meter.hear(0, heartbeat(2, 1, 1), VEHICLE, 10.0)
    meter.hear(1, heartbeat(2, 1, 1), OTHER_GROUND, 10.1)  # the same frame over the other link
    status = meter.meter.read(11.0, "recording: No space left on device")
    assert (status.links[0].crc_errors, status.links[0].noise_bytes) == (1, len(damaged))
    assert (status.duplicates, status.recorder_problem) == (1, "recording: No space left on device")
    assert status.links[0].problem is None


async def test_two_readings_at_one_time_divide_by_nothing(transports: list[Transport]) -> None:
    meter = Meter(transports)
    for _ in range(2):
        meter.hear(0, heartbeat(0, 1, 1), VEHICLE, 10.0)
        assert meter.meter.read(10.0).links[0].frames_in_per_s >= 0.0


async def test_the_status_is_json(transports: list[Transport]) -> None:
    status: BridgeStatus = Meter(transports).meter.read(1.0)
    again = json.loads(json.dumps(status.to_dict()))
    assert [link["endpoint"] for link in again["links"]] == [each.endpoint.text for each in transports]
    assert (again["routes"], again["recorder_problem"]) == ([], None)


@pytest.mark.parametrize(
    ("address", "text"), [(GROUND, "10.0.0.2:5002"), (("::1", 5, 0, 0), "::1:5"), ("/dev/ttyUSB0", "/dev/ttyUSB0")]
)
def test_an_address_is_one_word(address: object, text: str) -> None:
    assert address_text(address) == text
