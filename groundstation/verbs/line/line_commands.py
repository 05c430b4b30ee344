"""LineCommands: runs the lines of the screens one after the other, and answers for each how it stands."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from typing import Any

from dialects.enums import Severity
from groundstation.formats.errors import FileFormatError
from groundstation.intents.line import RunLine
from groundstation.station.driving.stops.blind_stops import EVERYBODY
from groundstation.station.station import Station
from groundstation.vehicles.demand.stop_commands import STOP_VERBS
from groundstation.vehicles.fleet import Contact
from groundstation.verbs.collected_output import CollectedOutput
from groundstation.verbs.common.arguments import is_chosen
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.line.overrides import OVERRIDES
from groundstation.verbs.line.parser import ParsedLine, parse_line
from groundstation.verbs.line.session import LineSession, here
from groundstation.verbs.line.words import complete
from groundstation.verbs.table import VERBS
from groundstation.views.line import ASKS, DONE, FAILED, RUNNING, LineRequest, LineView

LABEL = "line"
"""Label of the lines in the log."""
MOST_LINES = 200
"""Lines of data of one line that the log gets."""
MOST_RUNNING = 8
KEPT = 16
"""Lines whose end a screen can still read."""


class LineCommands:
    """The lines for `station`. `flush` sends what the station has queued."""

    def __init__(self, station: Station, flush: Callable[[], None]) -> None:
        self._station, self._flush = station, flush
        self._views: deque[LineView] = deque(maxlen=KEPT)
        self._tasks: set[asyncio.Task[None]] = set()

    def run(self, intent: RunLine, now: float) -> None:
        """Run a line, or ask first."""
        self._station.log.add(now, LABEL, f":{intent.text}", Severity.INFO)
        try:
            parsed = parse_line(intent.text, self._modes(intent.system))
            if parsed.name in STOP_VERBS and self._stop_blindly(intent, parsed, now):
                return
            contact = self._find(parsed, intent.system)
            if len(self._tasks) >= MOST_RUNNING:
                raise VerbError(ExitCode.REFUSED, f"{MOST_RUNNING} lines run; wait for the end of one")
        except (VerbError, FileFormatError) as error:
            self._end(intent, FAILED, [], here(str(error)))
            return
        if parsed.action.line.asks(parsed.options, contact.state) and not intent.confirmed:
            self._show(intent, ASKS, f"{contact.state.name}: {intent.text}?")
            return
        self._show(intent, RUNNING, f"{intent.text} ...")
        task = asyncio.get_running_loop().create_task(self._perform(intent, parsed, contact))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _stop_blindly(self, intent: RunLine, parsed: ParsedLine, now: float) -> bool:
        """Carry out a stop for a vehicle that is not heard, or all while none is; return whether that is so."""
        wanted = parsed.options.vehicle
        if getattr(parsed.options, "clear", False) or isinstance(wanted, str):
            return False
        if self._station.fleet.get(wanted) if wanted else self._station.fleet.selected:
            return False
        self._station.stop_blindly(STOP_VERBS[parsed.name], wanted or EVERYBODY, now)
        self._flush()
        target = f"vehicle {wanted}, which is not heard" if wanted else "all vehicles; none is heard yet"
        self._end(intent, DONE, [], here(f"{parsed.name} is sent to {target}"))
        return True

    def build(self, request: LineRequest) -> LineView:
        """Return how a line stands, and the words that complete the text."""
        contact = self._station.fleet.get(request.system) if request.system else self._station.fleet.selected
        services = None if contact is None else self._station.services.services_of(contact)
        words = complete(request.text, services) if request.text else ()
        known = next((view for view in reversed(self._views) if view.number == request.number), None)
        view = known or LineView(request.number, RUNNING, "", "")
        return LineView(view.number, view.state, view.note, request.text, words)

    def _modes(self, system: int) -> frozenset[str]:
        """Return the names of the modes of a vehicle that are not verbs, in capitals."""
        contact = self._station.fleet.get(system) if system else self._station.fleet.selected
        modes = () if contact is None else self._station.services.services_of(contact).modes.modes
        return frozenset(mode.name.upper() for mode in modes if mode.name.lower() not in VERBS)

    def _find(self, parsed: ParsedLine, system: int) -> Contact:
        """Return the vehicle: that of --vehicle, or the one that the operator saw. Raises VerbError."""
        wanted, fleet = parsed.options.vehicle or system, self._station.fleet
        named = (each for each in fleet if is_chosen(wanted, each.state.system, each.state.fleet_name))
        contact = next(named, None) if wanted else fleet.selected
        if contact is None:
            raise VerbError(ExitCode.NO_VEHICLE, f"no vehicle {wanted}" if wanted else "no vehicle yet")
        return contact

    async def _perform(self, intent: RunLine, parsed: ParsedLine, contact: Contact) -> None:
        session, output = LineSession(self._station, contact, self._flush), CollectedOutput(here)
        session.seat.join(session.now)
        run: Any = OVERRIDES.get(parsed.name, parsed.action.run)
        try:
            async with asyncio.timeout(parsed.options.timeout):
                code = await run(session, parsed.options, output)
        except TimeoutError:
            code = ExitCode.NO_ANSWER
            output.error(f"{parsed.name}: not done within {parsed.options.timeout:g} s")
        except VerbError as error:
            code = error.code
            output.error(str(error))
        finally:
            session.seat.leave()
        state = DONE if code == ExitCode.DONE else FAILED
        note = " · ".join(output.notes) or _summary(parsed.name, output, session.told)
        self._end(intent, state, output.lines, note, logged=note in (*session.told, *output.lines))

    def _end(self, intent: RunLine, state: str, lines: list[str], note: str, *, logged: bool = False) -> None:
        """Write the data and the note to the log, unless it is there already, and answer the screen."""
        now = asyncio.get_running_loop().time()
        severity = Severity.WARNING if state == FAILED else Severity.INFO
        for line in lines[:MOST_LINES]:
            self._station.log.add(now, LABEL, line, Severity.INFO)
        if len(lines) > MOST_LINES:
            self._station.log.add(now, LABEL, f"... {len(lines) - MOST_LINES} more lines", Severity.INFO)
        if not logged:
            self._station.log.add(now, LABEL, note, severity)
        self._show(intent, state, note)

    def _show(self, intent: RunLine, state: str, note: str) -> None:
        kept = [view for view in self._views if view.number != intent.request]
        self._views = deque([*kept, LineView(intent.request, state, note, "")], maxlen=KEPT)


def _summary(name: str, output: CollectedOutput, told: list[str]) -> str:
    """Return what a verb without notes has done."""
    if len(output.lines) == 1:
        return output.lines[0]
    return f"{name}: {len(output.lines)} lines in Log (F6)" if output.lines else told[-1] if told else f"{name}: done"
