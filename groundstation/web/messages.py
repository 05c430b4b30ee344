"""Messages of a tab: what textual.js and our page send over the socket, in JSON, and how much of it. No I/O."""

from __future__ import annotations

import msgspec

from groundstation.input.touch_stick import TouchReading
from link.protocol.rate import TokenBucket

MESSAGES, BURST = 400.0, 1200.0
"""Messages per s, and at once. A held key sends 30 per s, the mouse 120, the stick 40; the rest is for what a line has
held back for the 6 s after which the tab has ended."""

CHARACTERS, PASTES = 65_536.0, 262_144.0
"""Characters per s, and at once: four pasted texts of the largest size."""


class Typed(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True, tag="stdin"):
    """Keys, pasted text, and answers of the terminal."""

    text: str


class Size(msgspec.Struct, frozen=True):
    """Columns and rows; Tab.resize has the bounds."""

    width: int
    height: int


class Resized(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True, tag="resize"):
    """The size of the terminal."""

    size: Size


class Touched(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True, tag="pad"):
    """The page has a stick; sent once at first, at each change, and 20 times a second while anything is held."""

    reading: TouchReading


class Pinged(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True, tag="ping"):
    """Sent by textual.js once; nothing answers."""

    sent: str


class Focused(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True, tag="focus"):
    """Sent by textual.js; the terminal reports the same to the screen."""


class Blurred(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True, tag="blur"):
    """Sent by textual.js; the terminal reports the same to the screen."""


TabMessage = Typed | Resized | Touched | Pinged | Focused | Blurred
_DECODER: msgspec.json.Decoder[TabMessage] = msgspec.json.Decoder(TabMessage)


class TabMessageError(ValueError):
    """A message that is refused; the text is one line, and short enough to close a socket with."""


class TabMessages:
    """Reads the messages of one tab. Times are of one monotonic clock, s."""

    def __init__(self) -> None:
        self._messages = TokenBucket(MESSAGES, BURST)
        self._characters = TokenBucket(CHARACTERS, PASTES)

    def read(self, text: str, now: float) -> TabMessage:
        """Return a message. Raises TabMessageError for one that is malformed, and for too many."""
        if not self._messages.consume(now):
            raise TabMessageError(f"more than {MESSAGES:.0f} messages per s from this tab")
        if not self._characters.consume(now, len(text)):
            raise TabMessageError(f"more than {CHARACTERS:.0f} characters per s from this tab")
        try:
            return _DECODER.decode(text)
        except (msgspec.DecodeError, UnicodeEncodeError, RecursionError) as error:
            raise TabMessageError(f"malformed message from this tab{_place(error)}") from None


def _place(error: Exception) -> str:
    """Return which field is wrong, without the words of the message."""
    _, found, path = str(error).rpartition(" - at `")
    return f": {path.rstrip('`')[:40]}" if found else ""
