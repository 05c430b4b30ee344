"""Two ends of a fleet and a router without certificates, in one process: who comes, what passes, what is refused."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Callable, Hashable, Iterator, Sequence

import pytest
import zenoh
from msgspec.structs import replace

from dialects import messages as m
from dialects import rover as dialect
from link.endpoint import Side, parse_endpoint
from link.fleet.config import SETTINGS, apply_settings, load_config
from link.fleet.router_session import direct
from link.fleet.transport import FleetTransport, open_fleet
from tests.link.frames import demand, frame, heartbeat
from tests.ports import free_port
from tests.waits import PATIENCE

VEHICLE_BEAT = heartbeat(0, 1, 1)


class End:
    """A transport, and what it has received."""

    def __init__(self, endpoint: str, side: Side) -> None:
        self.transport: FleetTransport = open_fleet(replace(parse_endpoint(endpoint), side=side))
        self.received: list[tuple[bytes, Hashable]] = []
        self.gone: list[Hashable] = []

    def start(self) -> None:
        self.transport.start(asyncio.get_running_loop(), self.take, self.gone.append)

    def take(self, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        self.received += pieces


async def until(condition: Callable[[], object], again: Callable[[], object] = lambda: None) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        again()
        await asyncio.sleep(0.01)


def open_router(port: int) -> zenoh.Session:
    config = zenoh.Config()
    apply_settings(config, SETTINGS | {"mode": "router", "listen/endpoints": [f"tcp/127.0.0.1:{port}"]})
    return zenoh.open(config)


@pytest.fixture
def port() -> Iterator[int]:
    port = free_port()
    with open_router(port):
        yield port


def ends(port: int, *vehicles: str) -> tuple[End, ...]:
    """A ground station and vehicles, started."""
    base = f"zenoh:tcp/127.0.0.1:{port}/farm"
    found = End(base, Side.GROUND_STATION), *(End(f"{base}/{name}", Side.VEHICLE) for name in vehicles)
    for each in found:
        each.start()
    return found


async def test_frames_both_ways_and_what_is_refused(port: int) -> None:
    others = set(threading.enumerate())
    station, rover = ends(port, "rover1")
    assert (station.transport.problem or "").endswith(": connecting")
    await until(lambda: station.received and rover.received)
    (empty, vehicle), (_, me) = station.received[0], rover.received[0]
    assert (empty, vehicle, station.transport.problem) == (b"", "rover1", None)

    two = heartbeat(1) + frame(m.ParamRequestList(1, 1), 2)  # the bridge joins frames that wait at the same time
    station.transport.send(two, vehicle)
    await until(lambda: len(rover.received) == 3)
    assert sorted(data for data, _ in rover.received[1:]) == sorted((heartbeat(1), frame(m.ParamRequestList(1, 1), 2)))
    assert {address for _, address in rover.received} == {me}
    rover.transport.send(VEHICLE_BEAT, me)
    await until(lambda: (VEHICLE_BEAT, "rover1") in station.received)

    stranger = station.transport._session._router.session
    assert stranger is not None
    before = len(rover.received)
    key = f"fleet/farm/rover1/down/{me}/watch/ctl/HEARTBEAT"
    await until(lambda: rover.transport.refused >= 3, lambda: stranger.put(key, demand(0)))
    assert rover.transport.dropped >= 3
    assert rover.received[before:] == []
    for cut in (
        b"no frame",
        heartbeat(1)[:-3],
        frame(m.ParamRequestList(1, 1), 2)[:-3],
    ):  # messages went before
        dropped = station.transport.dropped
        station.transport.send(cut, vehicle)
        assert station.transport.dropped == dropped + 1
    assert [each.name for each in set(threading.enumerate()) - others] == ["fleet"] * 2  # none for each callback
    for each in (station, rover):
        each.transport.close()
    assert set(threading.enumerate()) <= others


@pytest.mark.parametrize(("autopilot", "passes"), [(3, True), (12, False)])
async def test_a_watchers_hold_reaches_ardurover_and_not_px4(port: int, autopilot: int, passes: bool) -> None:
    station, rover = ends(port, "rover1")
    await until(lambda: station.received and rover.received)
    me = rover.received[0][1]
    beat = frame(m.Heartbeat(10, autopilot, 129, 4, 4, 3), 0, 1, 1)
    rover.transport.send(beat, me)
    await until(lambda: (beat, "rover1") in station.received)
    watcher = station.transport._session._router.session
    assert watcher is not None
    hold = frame(m.SetMode(1, 1, 4))

    def put() -> None:
        watcher.put(f"fleet/farm/rover1/down/{me}/watch/cmd/SET_MODE", hold)

    if passes:
        await until(lambda: (hold, me) in rover.received, put)
    else:
        await until(lambda: rover.transport.refused >= 3, put)
        assert (hold, me) not in rover.received
        station.transport.send(hold, "rover1")  # under the role drive
        await until(lambda: (hold, me) in rover.received)
    for each in (station, rover):
        each.transport.close()


async def test_two_vehicles_with_one_system_id_are_not_taken_for_one(port: int) -> None:
    station, first, second = ends(port, "rover1", "rover2")
    await until(lambda: {address for _, address in station.received} == {"rover1", "rover2"})
    await until(lambda: first.received and second.received)
    first.transport.send(VEHICLE_BEAT, first.received[0][1])
    await until(lambda: (VEHICLE_BEAT, "rover1") in station.received)
    to = second.received[0][1]
    await until(lambda: station.transport.refused, lambda: second.transport.send(VEHICLE_BEAT, to))
    assert (VEHICLE_BEAT, "rover2") not in station.received
    second.transport.send(heartbeat(0, 2, 1), to)
    await until(lambda: (heartbeat(0, 2, 1), "rover2") in station.received)

    second.transport.close()
    await until(lambda: station.gone)
    assert station.gone == ["rover2"]
    for each in (station, first):
        each.transport.close()


async def test_only_selected_vehicles_send_all_of_their_telemetry(port: int) -> None:
    station, rover = ends(port, "rover1")
    await until(lambda: station.received and rover.received)
    me = rover.received[0][1]
    rover.transport.send(VEHICLE_BEAT, me)
    await until(lambda: (VEHICLE_BEAT, "rover1") in station.received)

    def send(count: int) -> None:
        for number in range(count):
            rover.transport.send(frame(m.Attitude(number, *(0.0,) * 6), number, 1, 1), me)
        rover.transport.send(frame(m.StatusText(6, b"end"), 0, 1, 1), me)

    async def arrives(count: int) -> int:
        station.received.clear()
        send(count)
        await until(lambda: any(data[7] == m.StatusText.id for data, _ in station.received))
        await asyncio.sleep(0.05)  # classes overtake each other
        return sum(data[7] == m.Attitude.id for data, _ in station.received)

    async def until_it_sends(least: int, most: int) -> None:
        deadline = time.monotonic() + PATIENCE
        while not least <= await arrives(20) <= most:
            assert time.monotonic() < deadline

    await until_it_sends(20, 20)
    station.transport.set_interest(frozenset())
    await until_it_sends(0, 1)
    station.transport.set_interest(frozenset((1,)))
    await until_it_sends(20, 20)
    station.transport.set_interest(frozenset((2,)))
    await until_it_sends(0, 1)
    station.transport.set_interest(None)
    await until_it_sends(20, 20)
    assert rover.transport.dropped == 0
    for each in (station, rover):
        each.transport.close()


async def test_without_a_router_the_link_says_why_and_connects_later() -> None:
    port = free_port()
    station, rover = ends(port, "rover1")
    refused = f"no router at tcp/127.0.0.1:{port} (connection refused); trying again"
    await until(lambda: refused in (station.transport.problem or ""))
    station.transport.send(heartbeat(0), "rover1")
    assert station.transport.dropped == 1
    with open_router(port):
        await until(lambda: station.received and rover.received)
        assert station.transport.problem is None
    await until(lambda: "connection to the router lost; no router at" in (station.transport.problem or ""))
    station.transport.set_interest(frozenset())
    station.transport.send(heartbeat(0), "rover1")
    assert station.transport.dropped == 2
    with open_router(port):
        await until(lambda: station.transport.problem is None and rover.transport.problem is None)
        me, before = rover.received[0][1], len(rover.received)
        await until(lambda: rover.received[before:], lambda: station.transport.send(heartbeat(1), "rover1"))
        assert rover.received[before] == (heartbeat(1), me)
        await until(lambda: rover.transport._brief._sent)
        await until(
            lambda: (VEHICLE_BEAT, "rover1") in station.received, lambda: rover.transport.send(VEHICLE_BEAT, me)
        )
    assert station.gone == rover.gone == []
    for each in (station, rover):
        each.transport.close()


@pytest.mark.parametrize("rest", ["nosuch.invalid:7447", "127.0.0.1:1"])
async def test_an_address_where_nothing_is(rest: str) -> None:
    end = End(f"zenoh:tls/{rest}/farm", Side.GROUND_STATION)
    end.start()
    await until(lambda: not (end.transport.problem or "").endswith("connecting"))
    assert ("is not known" in (end.transport.problem or "")) == ("nosuch" in rest)
    begun = time.monotonic()
    end.transport.close()
    assert time.monotonic() - begun < 2.0
    assert json.dumps(end.received) == "[]"


async def test_a_role_refuses_what_it_does_not_allow(port: int) -> None:
    endpoint = replace(parse_endpoint(f"zenoh:tcp/127.0.0.1:{port}/farm"), side=Side.GROUND_STATION)
    config = replace(load_config(endpoint), name="alice")

    def refusal(role: str | None, data: bytes, *, is_vehicle: bool = False) -> str | None:
        return FleetTransport(endpoint, replace(config, role=role), is_vehicle=is_vehicle).refusal(data)

    parameter = frame(m.ParamSet(1, 1, b"A", 1.0, 9), 1)
    assert refusal("watch", demand(0)) == "the certificate of alice may watch only; ask for the role drive"
    assert refusal("drive", parameter) == "the certificate of alice may drive only; ask for the role setup"
    allowed = [
        ("watch", heartbeat(0)),
        ("drive", demand(0)),
        ("setup", parameter),
        (None, parameter),
        ("watch", b"no frame"),
    ]
    assert [refusal(role, data) for role, data in allowed] == [None] * len(allowed)
    assert refusal("vehicle", demand(0), is_vehicle=True) is None


async def test_the_key_of_a_command_follows_each_of_them(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    station, rover = ends(port, "rover1")
    await until(lambda: station.received and rover.received)
    sent: list[str] = []

    def publish(key: str, data: bytes) -> bool:
        sent.append(key.split("/")[6])
        return True

    monkeypatch.setattr(station.transport._session, "publish", publish)
    reboot, hold = (
        frame(m.CommandLong(1, 1, number, 0, 1.0, *(0.0,) * 6), 1)
        for number in (dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, dialect.MAV_CMD_DO_SET_MODE)
    )
    for data in (hold, reboot, hold, demand(0), demand(1)):
        station.transport.send(data, "rover1")
    assert sent == ["drive", "setup", "drive", "drive", "drive"]
    for each in (station, rover):
        each.transport.close()


def test_a_zenoh_thread_keeps_its_python_state_between_callbacks(port: int) -> None:
    """Otherwise it is made and freed for each of them, which holds back the loop that the callback has woken."""
    config = zenoh.Config()
    apply_settings(config, SETTINGS | {"mode": "client", "connect/endpoints": [f"tcp/127.0.0.1:{port}"]})
    counts, own, heard = {}, threading.local(), threading.Semaphore(0)

    def take(sample: zenoh.Sample) -> None:
        own.count = counts[threading.get_ident()] = getattr(own, "count", 0) + 1
        heard.release()

    with zenoh.open(config) as receiver, zenoh.open(config) as sender:
        subscriber = receiver.declare_subscriber("kept", direct(take))
        while not counts:
            sender.put("kept", b"")
            heard.acquire(timeout=0.05)
        for _ in range(20):
            sender.put("kept", b"")
            assert heard.acquire(timeout=PATIENCE)
        subscriber.undeclare()  # type: ignore[no-untyped-call]
    assert threading.get_ident() not in counts
    assert sum(counts.values()) >= 21, "none was forgotten"
