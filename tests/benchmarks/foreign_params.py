"""How long all parameters of a vehicle as ArduPilot behaves take on UDP loopback, as a file and as a list."""

from __future__ import annotations

import asyncio
import time
from statistics import median

from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.running import run_over
from groundstation.verbs.session.session import VerbSession
from groundstation.verbs.session.station_seat import StationSeat
from link.runner import Runner
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Table, brief
from tests.fakes.params import many_params
from tests.fakes.services import foreign_vehicle

COUNT = 1200
"""Parameters; ArduRover 4.7 has 1235."""
BY_FILE, BY_LIST = 0.5, 2.0
"""s. ArduRover 4.7 itself needs 0.4 s for the file and 1.0 s for the list (measured before)."""


def run(options: Options) -> Report:
    """Fetch them in turns."""
    times: dict[str, list[float]] = {"file": [], "list": []}
    for turn in range(1 if options.quick else ROUNDS):
        options.say(f"foreign_params: round {turn + 1}")
        for name, taken in times.items():
            taken.append(_fetch(files=name == "file"))
    report = Report()
    note = f"{COUNT} parameters of four types. The vehicle runs in a thread of the same process."
    table = Table("Parameters of another autopilot on UDP loopback, s", note=note)
    table.rows += [{"as": name, "taken": median(taken)} for name, taken in times.items()]
    report.tables.append(table)
    as_list = f"as a list, {brief(median(times['list']))} s"
    report.goals += [
        Goal(f"{COUNT} parameters as a file", median(times["file"]), BY_FILE, "s", reference=as_list),
        Goal(f"{COUNT} parameters as a list", median(times["list"]), BY_LIST, "s"),
    ]
    return report


def _fetch(*, files: bool) -> float:
    """Return the s from the request to its end; the vehicle's capabilities are asked for before."""
    with foreign_vehicle(ftp=files) as vehicle:
        vehicle.params.replace(dict(many_params(COUNT)))

        async def fetch() -> int:
            core = VerbCore.alone((254, 190), 1, 1, now=asyncio.get_running_loop().time())
            session = VerbSession(core, lambda: None, _ignore)

            async def begin(runner: Runner) -> int:
                seat = StationSeat(core.station, core, "a benchmark", runner.flush, alone=True)
                session.flush = seat.flush
                return await seat.run(script(session))

            return await run_over([vehicle.endpoint], core.station, begin, ids=core.ids)

        async def script(session: VerbSession) -> int:
            await session.find_vehicle(20.0, 1)
            await session.request(session.services.modes.list_modes)
            began = time.monotonic()
            report = await session.request(session.services.params.fetch)
            taken.append(time.monotonic() - began)
            if report.state is not RequestState.ACCEPTED or len(session.services.params.client.params) != COUNT:
                raise BenchmarkError(report.text)
            return 0

        taken: list[float] = []
        asyncio.run(fetch())
    return taken[0]


def _ignore(report: RequestReport) -> None:
    """Take progress."""
