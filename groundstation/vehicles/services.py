"""The MAVLink services of one vehicle, as the ground station uses them: parameters, files and what it says of itself.

Each request has a number and ends in `book`. Nothing is sent before the first request, except by `due_message`.
"""

from __future__ import annotations

from dialects.enums import Autopilot, Severity
from groundstation.vehicles.file_requests import FileRequests
from groundstation.vehicles.identity import MessageRequest, VehicleIdentity
from groundstation.vehicles.param_requests import ParamRequests
from groundstation.vehicles.requests import RequestBook
from link.core import Outgoing, Received
from link.services.ftp.client import FtpClient
from link.services.param.client import ParamClient


class VehicleServices:
    """Services of the component `target` (system, component). `system` and `component` are our ids."""

    def __init__(self, system: int, component: int, target: tuple[int, int]) -> None:
        self._wanted = False
        to, at = target
        self.autopilot: int = Autopilot.GENERIC
        """MAV_AUTOPILOT of its HEARTBEAT."""
        self.book = RequestBook()
        self.identity = VehicleIdentity(target[1])
        self.files = FileRequests(FtpClient(system, component, target_system=to, target_component=at), self.book)
        params = ParamClient(system, component, target_system=to, target_component=at)
        self.params = ParamRequests(params, self.files, self.identity, self.book, lambda: self.autopilot)

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self.identity.receive(received)
        self.files.receive(received, now)
        self.params.receive(received, now)

    def handle_text(self, text: str, severity: Severity | int, now: float) -> None:
        """Take a whole STATUSTEXT of the vehicle."""
        self.book.handle_text(text, severity, now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, report progress, give up at last."""
        self._wanted = self._wanted or bool(self.book.running)
        self.files.tick(now)
        self.params.tick(now)
        self.book.tick(now)

    def due_message(self, now: float) -> MessageRequest | None:
        """Return the message to request of the vehicle now; call only while no other request is pending."""
        return self.identity.next_request(now) if self._wanted else None

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        return self.files.messages_to_send() + self.params.messages_to_send()
