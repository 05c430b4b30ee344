"""The keys of a fleet: where each frame is published, and whether a frame that arrives fits its key. Sans-IO.

    fleet/FLEET/VEHICLE/alive                                   a token while the vehicle is connected
    fleet/FLEET/VEHICLE/gcs/NAME/RUN                            a token while a ground station talks to it
    fleet/FLEET/VEHICLE/gcs/NAME/RUN/brief                      a token while a little of its telemetry is enough there
    fleet/FLEET/VEHICLE/up/NAME/RUN/CLASS/MESSAGE               a frame to that ground station
    fleet/FLEET/VEHICLE/down/NAME/RUN/ROLE/CLASS/MESSAGE        a frame to the vehicle

NAME is that of the operator, RUN a number of this run of the program. The router lets each certificate publish under
its own name and its own roles only (link/bridge/fleet/access.py). So the key says who sent a frame and what it may do,
and a frame whose role, class or message is not that of its key is refused: no command passes as a HEARTBEAT.
"""

from __future__ import annotations

import msgspec

from dialects.messages import MESSAGES
from link.fleet.roles import needed_role, watch_condition
from link.fleet.traffic import TELEMETRY, traffic_class
from link.protocol.frame import Frame
from link.protocol.framer import Framer
from link.signing.role import SigningRole

_BRIEF = "brief"
_CHUNKS = 6
"""Of a frame's key before role, class and message."""
_DIGITS_MAX = 8
"""Digits of a message id, which has 24 bits."""
MAX_KEYS = 8192
"""Keys that are kept parsed: 160 vehicles with 50 messages each."""
_IDS = {str(message.msgname): number for number, message in MESSAGES.items()}
"""Name of a message in a key -> its id."""


def message_word(message_id: int) -> str:
    """Return the name of a message in a key."""
    known = MESSAGES.get(message_id)
    return str(known.msgname) if known else f"ID{message_id}"


def _read_word(word: str) -> int | None:
    """Return the id of a message from its name in a key; None if no message has it."""
    if word in _IDS:
        return _IDS[word]
    digits = word[2:]
    if len(digits) > _DIGITS_MAX or not digits.isdecimal():
        return None
    number = int(digits)
    return number if message_word(number) == word else None


def new_framer() -> Framer:
    """Return what read_frame() reads with."""
    return Framer(stream=False, unknown=True)


def read_frame(data: bytes, framer: Framer | None = None) -> Frame | None:
    """Return the frame if `data` is exactly one whole frame with a good checksum, or of an unknown id.

    `framer`: one of new_framer() that reads many, in one thread.
    """
    frames = (framer or new_framer()).feed(data, 0.0)
    return frames[0] if len(frames) == 1 and frames[0][4] == data else None


class FleetPlace(msgspec.Struct, frozen=True):
    """What a key says of the frame under it."""

    sender: str
    """Address of who sent it."""
    message_id: int
    role: str
    """Word of the role that its sender claims for it; empty in a key to a ground station."""
    is_telemetry: bool

    def fits(self, frame: Frame) -> bool:
        """Return whether a frame is of this message and needs exactly this role, or may be a watcher's."""
        if frame[0] != self.message_id:
            return False
        return not self.role or needed_role(frame).word == self.role or self.is_conditional(frame)

    def is_conditional(self, frame: Frame) -> bool:
        """Return whether this is a watcher's frame that counts in some circumstances only."""
        return self.role == SigningRole.WATCH.word and watch_condition(frame) is not None


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
        return f"{self._base}/alive" if self.me else f"{self._base}/gcs/**"

    def token(self, address: str) -> str:
        """Return the token that tells `address` that this program is here; the same for all if it is a vehicle."""
        return f"fleet/{self.fleet}/{address}/gcs/{self.me}" if self.me else f"{self._base}/alive"

    def brief_token(self, address: str) -> str:
        """Return the token that tells a vehicle that a little of its telemetry is enough for this ground station."""
        return f"{self.token(address)}/{_BRIEF}"

    def read_brief(self, key: str) -> str | None:
        """Return the address of the ground station with this token; None if it is no such token."""
        base, _, last = key.rpartition("/")
        return self.read_token(base) if last == _BRIEF and not self.me else None

    def read_token(self, key: str) -> str | None:
        """Return the address of the program with this token; None if it is no such token."""
        chunks = key.split("/")
        if self.me:
            return chunks[2] if len(chunks) == 4 and chunks[3] == "alive" else None
        return "/".join(chunks[4:]) if len(chunks) == _CHUNKS and chunks[3] == "gcs" else None

    def place(self, frame: Frame, address: str, role: SigningRole | None = None) -> str:
        """Return the key under which to publish a frame for an address; `role`: None for the one that it needs."""
        base = f"fleet/{self.fleet}/{address}/down/{self.me}" if self.me else f"{self._base}/up/{address}"
        word = f"{(role or needed_role(frame)).word}/" if self.me else ""
        return f"{base}/{word}{traffic_class(frame[0]).word}/{message_word(frame[0])}"

    def parse(self, key: str) -> FleetPlace | None:
        """Return what a key says of the frame under it; None if it is the key of no frame to this program."""
        chunks = key.split("/")
        roles, rest = chunks[_CHUNKS:-2], chunks[-2:]
        if len(chunks) != _CHUNKS + (2 if self.me else 3):
            return None
        message_id = _read_word(rest[1])
        if message_id is None or traffic_class(message_id).word != rest[0]:
            return None
        sender = chunks[2] if self.me else "/".join(chunks[4:_CHUNKS])
        return FleetPlace(sender, message_id, "".join(roles), rest[0] == TELEMETRY.word)

    @property
    def _base(self) -> str:
        return f"fleet/{self.fleet}/{self.vehicle or '*'}"


class KeyReader:
    """Compares frames with their keys. Keys are kept parsed, because a sender has few and uses them again and again."""

    def __init__(self, keys: FleetKeys) -> None:
        self._keys = keys
        self._places: dict[str, FleetPlace | None] = {}
        self._framer = new_framer()

    def find(self, key: str) -> FleetPlace | None:
        """Return what a key says, as FleetKeys.parse(); may be called from any thread."""
        place = self._places.get(key, self)
        if place is self:
            if len(self._places) >= MAX_KEYS:
                self._places.clear()
            place = self._places[key] = self._keys.parse(key)
        return place  # type: ignore[return-value]

    def read(self, key: str, data: bytes) -> tuple[FleetPlace, Frame] | None:
        """Return what arrived; None unless `data` is exactly the one frame that its key names."""
        place, frame = self.find(key), read_frame(data, self._framer)
        return None if place is None or frame is None or not place.fits(frame) else (place, frame)
