"""Lines of the screens, run by a station over its own links to a vehicle as ArduPilot and PX4 behave."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from groundstation.intents.line import RunLine
from groundstation.intents.session import RenewLease
from groundstation.station.component import COMPONENT
from groundstation.station.station import Station
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.line.line_commands import LABEL
from groundstation.verbs.line.loader import LineLoader
from groundstation.views.line import ASKS, DONE, FAILED, RUNNING, LineRequest, LineView
from groundstation.views.log import LogRequest
from link.links import open_links
from link.runner import Runner
from tests.fakes.params import Param
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.waits import PATIENCE


class Lines:
    """A station whose lease is renewed."""

    def __init__(self, station: Station) -> None:
        self.station = station
        self._number = 0

    async def run(self, text: str, *, confirmed: bool = False) -> LineView:
        """Run a line, and return how it ended."""
        self._number += 1
        self.station.handle_intent(RunLine(self._number, text, 0, confirmed), now())
        return await self.until(lambda view: view.state != RUNNING, LineRequest(self._number))

    async def until(self, condition: Callable[[LineView], bool], request: LineRequest) -> LineView:
        """Return the first view for which it holds."""
        until = now() + PATIENCE
        while True:
            view = self.station.views.build(request, now(), 0.0)
            assert isinstance(view, LineView)
            if condition(view):
                return view
            assert now() < until, view
            await asyncio.sleep(0.01)

    async def see(self, condition: Callable[[], bool]) -> None:
        """Wait until it holds."""
        while not condition():  # noqa: ASYNC110 - with_station() has the timeout
            await asyncio.sleep(0.01)

    @property
    def vehicle(self) -> VehicleState:
        """The selected vehicle."""
        selected = self.station.fleet.selected
        assert selected is not None
        return selected.state

    @property
    def logged(self) -> list[str]:
        """Lines of the log."""
        page = self.station.log.build_page(LogRequest(), now(), 0.0)
        assert page is not None
        return [line.text for line in page.lines if line.label == LABEL]


def now() -> float:
    """Return the time of the loop."""
    return asyncio.get_running_loop().time()


def with_station(vehicle: ForeignVehicle, use: Callable[[Lines], Awaitable[None]], *others: ForeignVehicle) -> None:
    """Run a station that has found the vehicle."""
    endpoints = [each.endpoint for each in (vehicle, *others)]

    async def main() -> None:
        station = Station(endpoints, system=255, session=7, now=now())
        links = open_links(endpoints, system=255, component=COMPONENT)
        runner = Runner(station, links, period=0.02, route=False)
        running = asyncio.ensure_future(runner.run())

        async def renew() -> None:
            while True:
                station.handle_intent(RenewLease(), now())
                await asyncio.sleep(0.1)

        lease = asyncio.ensure_future(renew())
        LineLoader(station, runner.flush)
        lines = Lines(station)
        try:
            async with asyncio.timeout(2 * PATIENCE):
                await lines.see(lambda: station.fleet.selected is not None)
                await use(lines)
        finally:
            lease.cancel()
            runner.stop()
            await running

    asyncio.run(main())


def test_lines_run_verbs_for_the_vehicle() -> None:
    async def use(lines: Lines) -> None:
        held = await lines.run("mode HOLD")
        assert (held.state, vehicle.mode) == (DONE, 4), held
        read = await lines.run("param get FS_ACTION")
        assert (read.state, read.note) == (DONE, "FS_ACTION        2")
        asked = await lines.run("param set FS_ACTION 1")
        assert (asked.state, vehicle.params["FS_ACTION"].value) == (ASKS, 2.0)
        written = await lines.run("param set FS_ACTION 1", confirmed=True)
        assert (written.state, vehicle.params["FS_ACTION"].value) == (DONE, 1.0), written
        vehicle.change_mode(4)
        await lines.see(lambda: lines.vehicle.armed)
        started = await lines.run("mission start", confirmed=True)
        assert (started.state, vehicle.mode) == (DONE, 10), started
        assert started.note.endswith("drives by itself; `:stop` stops it"), started.note
        assert (await lines.run("stop")).state == DONE
        assert vehicle.mode == 4
        assert (await lines.run("auto")).state == ASKS
        assert (await lines.run("auto", confirmed=True)).state == DONE
        assert vehicle.mode == 10
        assert (await lines.run("Hold")).state == DONE
        assert vehicle.mode == 4
        assert (await lines.run("disarm")).state == DONE
        assert not vehicle.armed
        assert ":mode HOLD" in lines.logged
        assert "FS_ACTION        2" in lines.logged

    with foreign_vehicle() as vehicle:
        vehicle.params["FS_ACTION"] = Param(2.0)
        with_station(vehicle, use)


def test_a_line_requests_a_message_and_sets_its_rate() -> None:
    async def use(lines: Lines) -> None:
        read = await lines.run("request AUTOPILOT_VERSION")
        assert (read.state, "lines in Log (F6)" in read.note) == (DONE, True), read
        assert any(line.startswith("capabilities") for line in lines.logged)
        rate = await lines.run("rate ATTITUDE 5")
        assert (rate.state, "sends ATTITUDE at 5 Hz on this link" in rate.note) == (DONE, True), rate

    with foreign_vehicle() as vehicle:
        with_station(vehicle, use)


def test_refusals_and_mistakes_are_one_line() -> None:
    async def use(lines: Lines) -> None:
        vehicle.answers[42428] = (3, "")
        refused = await lines.run("command DO_REPOSITION 1", confirmed=True)
        assert refused.state == FAILED
        assert "refused" in refused.note
        nobody = await lines.run("mode HOLD -v 9")
        assert (nobody.state, nobody.note) == (FAILED, "no vehicle 9")
        wrong = await lines.run("mode")
        assert (wrong.state, wrong.note) == (FAILED, "mode: the following arguments are required: MODE")
        late = await lines.run("param get MISSING --timeout 0.3")
        assert (late.state, "not done within 0.3 s" in late.note) == (FAILED, True)

    with foreign_vehicle() as vehicle:
        vehicle.answers[192] = (3, "")
        vehicle.silent.add(20)
        with_station(vehicle, use)


def test_a_stop_needs_no_selected_and_no_heard_vehicle() -> None:
    async def use(lines: Lines) -> None:
        await lines.see(lambda: len(list(lines.station.fleet)) == 2)
        unheard = await lines.run("disarm -v 9")
        assert (unheard.state, unheard.note) == (DONE, "disarm is sent to vehicle 9, which is not heard")
        selected = lines.vehicle.system
        for vehicle in (one, two):
            vehicle.armed = True
            done = await lines.run(f"disarm -v {vehicle.system}")
            assert done.state == DONE, done
            assert not vehicle.armed
        assert lines.vehicle.system == selected

    with foreign_vehicle() as one, foreign_vehicle(system=2) as two:
        with_station(one, use, two)


def test_a_hostile_name_of_a_vehicle_completes_no_line() -> None:
    async def use(lines: Lines) -> None:
        await lines.run("param get FS_ACTION")
        view = await lines.run("param get '$(LS)'")
        assert view.state == DONE, view
        view = await lines.until(lambda view: bool(view.words), LineRequest(0, "param get "))
        assert "FS_ACTION" in view.words
        assert "$(LS)" not in view.words
        assert all(word.isidentifier() or word.startswith("--") for word in view.words)

    with foreign_vehicle() as vehicle:
        vehicle.params["FS_ACTION"] = Param(2.0)
        vehicle.params["$(LS)"] = Param(2.0)
        with_station(vehicle, use)


def test_modes_and_parameters_of_the_vehicle_complete_a_line() -> None:
    async def use(lines: Lines) -> None:
        await lines.run("param get FS_ACTION")
        view = await lines.until(lambda view: bool(view.words), LineRequest(0, "param set fs_"))
        assert (view.text, view.words) == ("param set fs_", ("FS_ACTION",))
        view = await lines.until(lambda view: bool(view.words), LineRequest(0, "mode SMART"))
        assert view.words == ("SMART_RTL",)

    with foreign_vehicle() as vehicle:
        vehicle.params["FS_ACTION"] = Param(2.0)
        with_station(vehicle, use)
