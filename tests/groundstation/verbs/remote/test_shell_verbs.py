"""Verbs of a shell that run in a station, over a real socket, with a vehicle as ArduPilot behaves."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable

import pytest

from dialects import messages as m
from dialects.axes import Axes, axis_map, build_manual_control
from dialects.enums import VehicleType
from groundstation.host.run_port import RunPort
from groundstation.intents.session import RenewLease
from groundstation.station.component import COMPONENT
from groundstation.station.station import Station
from groundstation.station_socket.verb_run import (
    ALIVE_WITHIN,
    STILL_WITHIN,
    RunVerb,
    VerbEnded,
    VerbReady,
    decode_from_station,
)
from groundstation.verbs.client.station_choice import StationLink
from groundstation.verbs.client.verb_client import VerbClient
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.station_seat import StationSeat
from link.core import Received
from link.links import open_links
from link.runner import Runner
from link.runtime.local_socket import open_pair
from tests.fakes.params import Param
from tests.fakes.services import ARDUPILOT, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.setup.test_doctor import MAG_CAL_CANCEL, MAG_CAL_START, commanded, progress
from tests.waits import PATIENCE

Use = Callable[["Shells"], Awaitable[None]]


class Shells:
    """A station without a screen that has found its vehicle, and shells beside it."""

    def __init__(self, station: Station, flush: Callable[[], None]) -> None:
        self.station = station
        self.flush = flush

    def connect(self) -> StationLink:
        """Return the end of a shell."""
        ours, theirs = open_pair()
        for each in (ours, theirs):
            each.setblocking(False)
        port = RunPort(theirs, self.station, "a shell", self.flush, RunPort.close, follows=False)
        port.start(VerbReady(("here",)))
        ready = decode_from_station(ours.recv(1 << 16))
        assert isinstance(ready, VerbReady)
        return StationLink(ours, ready.endpoints)

    async def run(self, *words: str, given: object = None, dialect: str = "") -> VerbEnded:
        """Run a verb to its end; it prints to stdout and stderr."""
        as_json = "--json" in words
        client = VerbClient(self.connect(), Output(words[0], as_json=as_json, quiet=False))
        return await client.run(RunVerb(words, None, given, dialect))

    async def see(self, condition: Callable[[], bool]) -> None:
        """Wait until it holds."""
        while not condition():  # noqa: ASYNC110 - with_station() has the timeout
            await asyncio.sleep(0.01)


def with_station(vehicle: ForeignVehicle, use: Use) -> None:
    async def main() -> None:
        now = asyncio.get_running_loop().time
        station = Station([vehicle.endpoint], system=255, session=7, now=now())
        runner = Runner(
            station, open_links([vehicle.endpoint], system=255, component=COMPONENT), period=0.02, route=False
        )
        running = asyncio.ensure_future(runner.run())
        shells = Shells(station, runner.flush)
        try:
            async with asyncio.timeout(2 * PATIENCE):
                station.handle_intent(RenewLease(), now())  # its heartbeat is what the vehicle answers to
                await shells.see(lambda: station.fleet.selected is not None)
                await shells.see(lambda: not station.operator.live)
                await use(shells)
        finally:
            runner.stop()
            await running

    asyncio.run(main())


def test_it_prints_in_the_shell_and_has_its_code(capsys: pytest.CaptureFixture[str]) -> None:
    async def use(shells: Shells) -> None:
        assert (await shells.run("modes")).code == ExitCode.DONE
        assert "> MANUAL" in capsys.readouterr().out
        assert await shells.run("mode", "HOLD") == VerbEnded(ExitCode.DONE, "ArduPilot rover 1")
        assert vehicle.mode == 4
        assert (await shells.run("param", "get", "FS_ACTION", "--json")).code == ExitCode.DONE
        assert '"param_id": "FS_ACTION", "param_value": 2.0' in capsys.readouterr().out
        assert (await shells.run("mode", "NOWHERE")).code == ExitCode.REFUSED
        assert "no such mode" in capsys.readouterr().err
        assert (await shells.run("status", "-v", "9", "--wait", "0.1")).code == ExitCode.NO_VEHICLE
        assert (await shells.run("rate", "NOTHING", "5")).code == ExitCode.USAGE
        assert not shells.station.verbs.busy

    with foreign_vehicle() as vehicle:
        vehicle.params["FS_ACTION"] = Param(2.0)
        with_station(vehicle, use)


@pytest.mark.parametrize("killed", [False, True])
def test_an_interrupted_or_killed_shell_ends_its_verb_in_order(killed: bool) -> None:
    async def use(shells: Shells) -> None:
        link = shells.connect()
        client = VerbClient(link, Output("calibrate", as_json=False, quiet=True))
        verb = asyncio.ensure_future(client.run(RunVerb(("calibrate", "compass"))))
        await shells.see(lambda: commanded(vehicle, MAG_CAL_START))
        if killed:
            link.sock.shutdown(socket.SHUT_RDWR)
        verb.cancel()
        await shells.see(lambda: commanded(vehicle, MAG_CAL_CANCEL))
        await shells.see(lambda: not shells.station.verbs.busy)
        await asyncio.wait({verb})

    with foreign_vehicle() as vehicle:
        vehicle.on_command[MAG_CAL_START] = lambda: vehicle.send(progress(40))
        with_station(vehicle, use)


def test_a_verb_gets_no_signing_key_that_is_heard() -> None:
    heard: list[m.SetupSigning] = []

    def tap(received: Received, now: float) -> None:
        if isinstance(received.message, m.SetupSigning):
            heard.append(received.message)

    async def use(shells: Shells) -> None:
        core = VerbCore(shells.station, 1)
        seat = StationSeat(shells.station, core, "a shell", shells.flush)
        core.taps.append(tap)
        seat.join(asyncio.get_running_loop().time())
        vehicle.send(m.SetupSigning(255, 190, [7] * 32, 1))
        await shells.see(lambda: bool(heard))
        assert not any(heard[0].secret_key)
        seat.leave()

    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)


def test_the_verb_of_a_shell_that_stands_still_sends_nothing() -> None:
    silence = [0.0]

    async def use(shells: Shells) -> None:
        core = VerbCore(shells.station, 1)
        station, flush = shells.station, shells.flush
        seat = StationSeat(station, core, "a shell", flush, needs_session=True, silence=lambda now: silence[0])
        seat.join(asyncio.get_running_loop().time())
        await shells.see(lambda: core.chosen is not None)
        silence[0] = STILL_WITHIN + 0.01
        core.send(ping)
        seat.flush()
        until = core.contacts[1].state.heartbeat_at + 2.5
        await shells.see(lambda: core.contacts[1].state.heartbeat_at > until)
        assert vehicle.of("PING") == []
        silence[0] = 0.0
        await shells.see(lambda: bool(vehicle.of("PING")))
        seat.leave()

    ping = m.Ping(1, 2, 0, 0)
    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)


def test_the_demand_of_a_shell_that_stands_still_ends() -> None:
    silence = [0.0]

    async def use(shells: Shells) -> None:
        core = VerbCore(shells.station, 1)
        station, flush = shells.station, shells.flush
        seat = StationSeat(station, core, "a shell", flush, needs_session=True, silence=lambda now: silence[0])
        seat.join(asyncio.get_running_loop().time())
        await shells.see(lambda: core.chosen is not None)
        core.demand(ahead, moves=True)
        seat.flush()
        await shells.see(lambda: [each.z for each in vehicle.of("MANUAL_CONTROL")][-1:] == [ahead.z])
        silence[0] = ALIVE_WITHIN + 0.05
        await shells.see(lambda: vehicle.of("MANUAL_CONTROL")[-1].z == neutral.z)
        core.demand(ahead, moves=True)
        seat.flush()
        with pytest.raises(VerbError, match=r"a shell stood still for .* s: its demand has ended"):
            await seat.broken
        seat.leave()
        assert vehicle.of("MANUAL_CONTROL")[-1].z == neutral.z

    axes = axis_map(ARDUPILOT, VehicleType.GROUND_ROVER)
    ahead, neutral = (build_manual_control(Axes(throttle, 0.0), 1, axes) for throttle in (0.4, 0.0))
    assert (ahead.z, neutral.z) == (400, 0)
    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)


def test_a_course_of_the_shell_drives_and_ends_neutral(capsys: pytest.CaptureFixture[str]) -> None:
    async def use(shells: Shells) -> None:
        course = {"axes": {"throttle": 0.4, "steering": 0.0}, "seconds": 0.5}
        words = ("drive", "--throttle", "40", "--for", "0.5", "--arm")
        ended = await shells.run(*words, given=course)
        assert (ended.code, vehicle.armed) == (ExitCode.DONE, False), capsys.readouterr().err
        assert "was driven for 0.5 s, then neutral, and is disarmed" in capsys.readouterr().err
        sent = [each.z for each in vehicle.of("MANUAL_CONTROL")]
        assert (sent[0], set(sent), sent[-5:]) == (0, {0, 400}, [0] * 5)

    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)


def test_a_dialect_that_the_station_lacks_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    async def use(shells: Shells) -> None:
        ended = await shells.run("modes", "--dialect", "my.xml", dialect="of another file")
        assert ended.code == ExitCode.USAGE
        assert capsys.readouterr().err == (
            "mavhelm: my.xml: the station does not know this dialect: "
            "start the station with the same --dialect, or take --station never\n"
        )

    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)


def test_a_mistake_in_a_verb_ends_that_verb_alone() -> None:
    def fail(received: object, now: float) -> None:
        raise RuntimeError("a mistake")

    async def use(shells: Shells) -> None:
        core = VerbCore(shells.station, 1)
        seat = StationSeat(shells.station, core, "a shell", shells.flush)
        seat.join(asyncio.get_running_loop().time())
        core.taps.append(fail)
        with pytest.raises(RuntimeError, match="a mistake"):
            await seat.broken
        seat.leave()
        assert (await shells.run("mode", "HOLD")).code == ExitCode.DONE

    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)
