"""`status --watch --changes`: a line for each change of state and for each text of the vehicle.

For screen readers, logs and scripts, where a screen or a line each second is too much. Values that change all the time
(position, speed, voltage) are left to `status`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from dialects.enums import Severity
from groundstation.speech.announcements import (
    Announcement,
    SpokenState,
    StateAnnouncer,
    is_worth_saying,
    spoken_state,
    text_announcement,
)
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.contact import VehicleContact
from groundstation.views.log import LogRequest


class ChangePrinter:
    """Compares the state of a vehicle with what was printed last.

    `read_state` returns label -> text of what is compared, `read_fields` the object to print with --json.
    """

    def __init__(
        self,
        contact: VehicleContact,
        output: Output,
        read_state: Callable[[float], Mapping[str, str]],
        read_fields: Callable[[float], Mapping[str, Any]],
    ) -> None:
        self._contact = contact
        self._output = output
        self._read_state, self._read_fields = read_state, read_fields
        self._shown: Mapping[str, str] = {}
        self._log_state = 0
        self._announcer = StateAnnouncer()
        self._texts_are_new = False
        """Not those that were known before the first look."""

    def print_changes(self, now: float) -> None:
        """Print what is new, the vehicle's texts first: they often give the reason."""
        clock = datetime.now(UTC)
        page = self._contact.texts.build_page(LogRequest(after=self._log_state), now, clock.timestamp())
        if page is not None:
            self._log_state = page.state
            for line in page.lines:
                severity = Severity(min(line.severity, Severity.DEBUG)).name
                self._print(clock, f"{severity.lower()}: {line.text}", {"severity": severity, "text": line.text})
                if self._texts_are_new and is_worth_saying(line.severity):
                    self._announce([text_announcement(line.severity, line.text)])
        self._texts_are_new = True
        state = self._read_state(now)
        changed = [f"{label} {text}" for label, text in state.items() if self._shown.get(label) != text]
        if changed:
            self._shown = state
            self._print(clock, ", ".join(changed), self._read_fields(now))
        self._announce(self._announcer.update(self._spoken(now)))
        self._output.flush()

    def _spoken(self, now: float) -> SpokenState:
        state = self._contact.state
        view = state.build_view(now, in_control=self._contact.in_control, emergency_stop=state.emergency_stop)
        return spoken_state(view)

    def _announce(self, announcements: Sequence[Announcement]) -> None:
        for each in announcements:
            self._output.announce(each.priority, each.text)

    def _print(self, clock: datetime, text: str, fields: Mapping[str, Any]) -> None:
        state, time = self._contact.state, clock.isoformat(timespec="milliseconds").replace("+00:00", "Z")
        self._output.record(**{"time": time, "vehicle": state.system, **fields})
        self._output.line(f"{clock:%H:%M:%SZ} {state.name}: {text}")
