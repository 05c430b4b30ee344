"""One verb for many vehicles at once: `--all` and `--group`. Prints a table of the results, one row a vehicle.

The verb itself runs unchanged, once for each vehicle, as soon as the vehicle is heard; they share the links.
"""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Sequence
from copy import copy
from typing import TYPE_CHECKING, Any

import msgspec

from groundstation.config.groups import VehicleGroup
from groundstation.formats.errors import FileFormatError
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES
from groundstation.verbs.collected_output import CollectedOutput
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, worst_code
from groundstation.verbs.common.output import Output
from groundstation.verbs.common.tables import format_table
from groundstation.verbs.session.session import VerbSession

if TYPE_CHECKING:
    from groundstation.verbs.action import VerbAction

STATION_TELLS_WITHIN = 0.3
"""s without a further vehicle after which a station that knows all vehicles has told them."""
RESULTS = {
    ExitCode.DONE: "done",
    ExitCode.BROKEN: "failed",
    ExitCode.USAGE: "not possible",
    ExitCode.NO_VEHICLE: "not heard",
    ExitCode.REFUSED: "refused",
    ExitCode.NO_ANSWER: "no answer",
    ExitCode.NOT_IN_CONTROL: "not in control",
    ExitCode.DIFFERS: "differs",
    ExitCode.PARTLY: "partly done",
}
"""Exit code of one vehicle -> how the table says it."""


class VehicleResult(msgspec.Struct, frozen=True):
    """How the verb ended for one vehicle."""

    system: int
    name: str
    code: int
    words: tuple[str, ...] = ()
    """What the verb printed for it."""


class ManyVehicles:
    """Runs one action for each vehicle of a group."""

    def __init__(
        self, session: VerbSession, action: VerbAction, options: argparse.Namespace, group: VehicleGroup, output: Output
    ) -> None:
        self._session, self._action, self._options = session, action, options
        self._group, self._output = group, output
        self._results: list[VehicleResult] = []
        self._begun: set[int] = set()

    async def run(self) -> int:
        """Run for all vehicles at once; return the worst exit code. Raises VerbError if no vehicle is meant."""
        async with asyncio.TaskGroup() as tasks:
            while True:
                for each in self._session.of_others():
                    self._begin(each, tasks)
                if not await self._hears_more():
                    break
        self._add_missing()
        if not self._results:
            contacts = self._session.core.contacts
            heard = ", ".join(contacts[each].state.name for each in sorted(contacts))
            raise VerbError(ExitCode.NO_VEHICLE, f"no vehicle of {self._options.group} among {heard}")
        self._print()
        return worst_code(each.code for each in self._results)

    def _begin(self, session: VerbSession, tasks: asyncio.TaskGroup) -> None:
        state = session.vehicle
        if state.system not in self._begun and self._group.has(state.system, state.fleet_name, state.kind_name):
            self._begun.add(state.system)
            tasks.create_task(self._run_one(session))

    async def _hears_more(self) -> bool:
        """Wait for a further vehicle; return whether one was heard, or is still missing and in time."""
        core, now = self._session.core, self._session.now
        known = len(core.contacts)
        quiet = self._session.next_within(STATION_TELLS_WITHIN)
        if (self._missing or self._unheard_names) and not core.has_heard_all:
            quiet = max(quiet, self._session.began + self._options.wait - now)
        if known >= MAX_VEHICLES:
            return False
        return await self._session.wait_until_true(lambda: len(core.contacts) > known, quiet)

    @property
    def _missing(self) -> set[int]:
        return set(self._group.listed) - self._begun

    @property
    def _unheard_names(self) -> frozenset[str]:
        """The names of the group that no vehicle has, of a fleet or as a model, in lower case."""
        states = [contact.state for contact in self._session.core.contacts.values()]
        heard = {name.lower() for state in states for name in (state.fleet_name, state.kind_name)}
        return self._group.named - heard

    def _add_missing(self) -> None:
        for system in self._missing:
            self._add(VehicleResult(system, f"Vehicle {system}", ExitCode.NO_VEHICLE), CollectedOutput())

    async def _run_one(self, session: VerbSession) -> None:
        output, state = CollectedOutput(), session.vehicle
        options = copy(self._options)
        options.vehicle = state.system
        try:
            async with asyncio.timeout(self._options.timeout if not self._action.own_timeout else None):
                code = await self._perform(session, options, output)
        except (VerbError, FileFormatError) as error:
            output.error(str(error))
            code = error.code if isinstance(error, VerbError) else ExitCode.USAGE
        except TimeoutError:
            output.error(f"not done within {self._options.timeout:g} s")
            code = ExitCode.NO_ANSWER
        self._add(
            VehicleResult(state.system, state.name, code, output.words(state.name, brief=code == ExitCode.DONE)), output
        )

    async def _perform(self, session: VerbSession, options: argparse.Namespace, output: Any) -> int:
        if self._action.needs_session:
            await session.prove_session()
        if self._action.shows_neutral:
            await session.show_neutral()
        return await self._action.run(session, options, output)

    def _add(self, result: VehicleResult, output: CollectedOutput) -> None:
        self._results.append(result)
        self._output.count(self._output.verb, len(self._results), len(self._begun))
        self._output.result(
            result.code == ExitCode.DONE,
            result.system,
            **output.fields,
            name=result.name,
            code=int(result.code),
            result=RESULTS[ExitCode(result.code)],
            text="; ".join(output.notes),
            data=output.records,
        )

    def _print(self) -> None:
        rows = [row for each in sorted(self._results, key=lambda each: each.system) for row in _rows(each)]
        for line in format_table(("vehicle", "result", ""), rows):
            self._output.line(line)
        self._output.note(_summary(self._results))


def _rows(result: VehicleResult) -> list[tuple[str, str, str]]:
    """Return a row, and a further one for each further line that the verb printed."""
    first, *further = result.words or ("",)
    return [(result.name, RESULTS[ExitCode(result.code)], first), *(("", "", each) for each in further)]


def _summary(results: Sequence[VehicleResult]) -> str:
    codes = [ExitCode(each.code) for each in results]
    counts = (f"{codes.count(code)} {word}" for code, word in RESULTS.items() if code in codes)
    return f"{len(results)} vehicle{'' if len(results) == 1 else 's'}: {', '.join(counts)}"
