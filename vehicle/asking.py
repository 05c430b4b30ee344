"""Commands that only the ground station in control may give, and how a refusal is told."""

from __future__ import annotations

from dialects.enums import Command, Result, Severity
from link.services.command import CommandRequest, Handler, Run
from link.services.command_jobs import Job
from vehicle.control import Control
from vehicle.texts import Texts


class Asking:
    """Knows who is in control, and what to say to the others."""

    def __init__(self, control: Control, texts: Texts) -> None:
        self._control = control
        self._texts = texts

    def of_owner(self, run: Run) -> Handler:
        """A handler for the ground station in control, or any introduced one where nobody is."""

        def checked(request: CommandRequest, now: float) -> Result | Job:
            refusal = self.stranger(request)
            return self.refuse(request, refusal, now) if refusal else run(request, now)

        return Handler(checked)

    def stranger(self, request: CommandRequest) -> str | None:
        """Why its sender may not command, or None."""
        return self._control.stranger(request.system) if request.introduced else "no HEARTBEAT heard"

    def refuse(self, request: CommandRequest, why: str, now: float) -> Result:
        """Something must be put right first; the driver reads what."""
        name = Command(request.command).name
        self._texts.say(Severity.WARNING, f"GCS {request.system}: {name} refused: {why}", now)
        return Result.FAILED
