"""The keys of a fleet: where each frame is published, and whether a frame that arrives fits its key. Sans-IO.

    fleet/FLEET/VEHICLE/alive                                   a token while the vehicle is connected
    fleet/FLEET/VEHICLE/gcs/NAME/RUN                            a token while a ground station talks to it
    fleet/FLEET/VEHICLE/up/NAME/RUN/CLASS/MESSAGE               a frame to that ground station
    fleet/FLEET/VEHICLE/down/NAME/RUN/ROLE/CLASS/MESSAGE        a frame to the vehicle

NAME is that of the operator, RUN a number of this run of the program. The router lets each certificate publish under
its own name and its own roles only (link/bridge/fleet/access.py). So the key says who sent a frame and what it may do,
and a frame whose role, class or message is not that of its key is refused: no command passes as a HEARTBEAT.
"""

from __future__ import annotations

import msgspec

from dialects.messages import MESSAGES
from link.fleet.roles import needed_role
from link.fleet.traffic import traffic_class
from link.protocol.frame import Frame
from link.protocol.framer import Framer

_CHUNKS = 6
"""Of a frame's key before role, class and message."""


def message_word(message_id: int) -> str:
    """Return the name of a message in a key."""
    known = MESSAGES.get(message_id)
    return str(known.msgname) if known else f"ID{message_id}"


def read_frame(data: bytes) -> Frame | None:
    """Return the frame if `data` is exactly one whole frame with a good checksum, or of an unknown id."""
    frames = Framer(stream=False, unknown=True).feed(data, 0.0)
    return frames[0] if len(frames) == 1 and frames[0][4] == data else None


class FleetKeys(msgspec.Struct, frozen=True):
    """The keys of one program. `vehicle`: the vehicle that it is or wants; empty for all."""

    fleet: str
    vehicle: str
    me: str | None
    """Name and run of a ground station, as "alice/3f2a"; None for a vehicle."""

    @property
    def frames(self) -> str:
        """Where the frames to this program arrive."""
        return f"{self._base}/up/{self.me}/**" if self.me else f"{self._base}/down/*/*/**"

    @property
    def others(self) -> str:
        """The tokens of those to talk to."""
        return f"{self._base}/alive" if self.me else f"{self._base}/gcs/*/*"

    def token(self, address: str) -> str:
        """Return the token that tells `address` that this program is here; the same for all if it is a vehicle."""
        return f"fleet/{self.fleet}/{address}/gcs/{self.me}" if self.me else f"{self._base}/alive"

    def read_token(self, key: str) -> str | None:
        """Return the address of the program with this token; None if it is no such token."""
        chunks = key.split("/")
        if self.me:
            return chunks[2] if len(chunks) == 4 and chunks[3] == "alive" else None
        return "/".join(chunks[4:]) if len(chunks) == _CHUNKS and chunks[3] == "gcs" else None

    def place(self, frame: Frame, address: str) -> str:
        """Return the key under which to publish a frame for an address."""
        base = f"fleet/{self.fleet}/{address}/down/{self.me}" if self.me else f"{self._base}/up/{address}"
        return f"{base}/{self._suffix(frame, to_vehicle=bool(self.me))}"

    def read(self, key: str, data: bytes) -> tuple[str, Frame] | None:
        """Return sender and frame of what arrived; None if it is not the frame that its key names."""
        chunks = key.split("/")
        frame = read_frame(data)
        if frame is None or len(chunks) <= _CHUNKS:
            return None
        if "/".join(chunks[_CHUNKS:]) != self._suffix(frame, to_vehicle=not self.me):
            return None
        return chunks[2] if self.me else "/".join(chunks[4:_CHUNKS]), frame

    @property
    def _base(self) -> str:
        return f"fleet/{self.fleet}/{self.vehicle or '*'}"

    @staticmethod
    def _suffix(frame: Frame, *, to_vehicle: bool) -> str:
        role = f"{needed_role(frame).word}/" if to_vehicle else ""
        return f"{role}{traffic_class(frame[0]).word}/{message_word(frame[0])}"
