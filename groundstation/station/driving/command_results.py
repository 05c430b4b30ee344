"""Results of commands as texts: accepted or refused for the log, and each vehicle's last refusal with its reason."""

from __future__ import annotations

import math
from typing import NamedTuple

from dialects.enums import Command, Result, Severity, result_name
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.vehicles.demand.stop_commands import DANGEROUS
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.reason_texts import REASON_WITHIN, ReasonTexts
from link.services.command.client import CommandOutcome

SHOWN_FOR = 20.0
"""s for which a refusal is shown; after that what was wrong may have changed, and the log keeps it."""

ARM = "arm"
"""What every refusal to arm starts with."""


class _Refusal(NamedTuple):
    text: str
    at: float
    reason: str = ""


_NOTHING = _Refusal("", -math.inf)


class CommandResults:
    """Logs results and joins refusals with the STATUSTEXT that explains them."""

    def __init__(self, log: MessageLog) -> None:
        self._log = log
        self._labels: dict[tuple[int, int], str] = {}
        """System id and command -> what the newest command of that kind is called in texts."""
        self._refusals: dict[int, _Refusal] = {}
        self._reasons: dict[int, ReasonTexts] = {}

    def set_label(self, system: int, command: Command, label: str) -> None:
        """Set what a command to this vehicle is called in texts."""
        self._labels[system, command] = label

    def last_refusal(self, system: int, ready_at: float | None, now: float) -> str | None:
        """Return what this vehicle refused last and why; None after a command was accepted, and when that is old.

        `ready_at`: when the vehicle's pre-arm checks were passed; a refusal to arm before that holds no more.
        """
        text, at, reason = self._refusals.get(system, _NOTHING)
        outdated = text.startswith(ARM) and ready_at is not None and ready_at > at
        return None if outdated or now - at > SHOWN_FOR else f"{text}: {reason}" if reason else text

    def handle_outcome(self, outcome: CommandOutcome, now: float) -> None:
        """Log how a command ended."""
        label, origin = self._label(outcome), LogOrigin(outcome.target_system, result=outcome.number)
        if outcome.result is Result.ACCEPTED:
            self._refusals.pop(outcome.target_system, None)
            self._log.add(now, "ack", f"{label} accepted", Severity.INFO, origin=origin)
        elif outcome.command == Command.REQUEST_OPERATOR_CONTROL and outcome.result is Result.UNSUPPORTED:
            self._refusals.pop(
                outcome.target_system, None
            )  # no refusal: ArduPilot and PX4 take demands from any station
            whose = "you drive" if outcome.params[0] == 1 else "it gets no more demands from here"
            self._log.add(now, "ack", f"this vehicle does not manage control, {whose}", Severity.INFO, origin=origin)
        elif outcome.refusal:
            self.add_refusal(outcome.target_system, f"{label}: {outcome.refusal}", now)
        elif outcome.number is None:
            self.add_refusal(outcome.target_system, f"{label}: no answer", now)
        else:
            self.add_refusal(outcome.target_system, f"{label} {result_name(outcome.number)}", now, outcome.number)

    def add_refusal(self, system: int, text: str, now: float, result: int | None = None) -> None:
        """Log a refusal, and keep it with the vehicle's reason. `result`: MAV_RESULT of its COMMAND_ACK."""
        self._log.add(now, "ack", text, Severity.WARNING, origin=LogOrigin(system, result=result))
        self._refusals[system] = _Refusal(text, now)
        self._explain(system, now)

    def handle_statustext(self, system: int, text: str, severity: int, now: float) -> None:
        """Keep a text of the vehicle: it may explain a refusal just before or after it."""
        self._reasons.setdefault(system, ReasonTexts()).add(text, severity, now)
        self._explain(system, now)

    def _explain(self, system: int, now: float) -> None:
        refusal, texts = self._refusals.get(system, _NOTHING), self._reasons.get(system)
        if texts is not None and now - refusal.at <= REASON_WITHIN and ": " not in refusal.text:
            self._refusals[system] = refusal._replace(reason=texts.explain(refusal.at))

    def _label(self, outcome: CommandOutcome) -> str:
        first = outcome.params[0]
        match outcome.command:
            case Command.COMPONENT_ARM_DISARM:
                return "arm" if first == 1 else "disarm"
            case Command.DO_SET_SAFETY_SWITCH_STATE:
                return "release the emergency stop" if first == DANGEROUS else "emergency stop"
            case _:
                return self._labels.get((outcome.target_system, outcome.command), f"command {outcome.command}")
