"""Sample: one record of a log, as exporters get it; decoded when a value is needed first."""

from __future__ import annotations

from dialects.codec import decode_frame
from dialects.messages import MESSAGES, Message
from link.tlog.scan import LogFrame


class Sample:
    """A frame with its time: Unix time, us."""

    __slots__ = ("_message", "chosen", "component", "id", "kind", "microseconds", "raw", "sequence", "system")

    def __init__(self, frame: LogFrame) -> None:
        _, self.microseconds, self.id, self.system, self.component, self.sequence, self.raw = frame
        self.kind = MESSAGES.get(self.id)
        """Class of the message; None: its id is in no dialect known here."""
        self.chosen = False
        """It is to be exported. Others are only there to know the vehicle's state by."""
        self._message: Message | None = None

    @property
    def name(self) -> str:
        """Name of the message; "" if it is not known."""
        return self.kind.msgname if self.kind is not None else ""

    @property
    def message(self) -> Message:
        """The decoded message; the id must be known."""
        if self._message is None:
            self._message = decode_frame(self.id, self.raw)
        return self._message
