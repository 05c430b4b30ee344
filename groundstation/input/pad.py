"""Gamepad core: what was read of a gamepad and the time in, frames for the screen out. Knows no device.

A frame is the whole state: a lost one is replaced by the next.
"""

from __future__ import annotations

import math

import msgspec

from groundstation.input.pad_mapping import FLIGHT_MODES, PadMapping

HELD_PERIOD, IDLE_PERIOD = 0.05, 0.5
"""s between frames while a button is held (20 a second, as the demands), and while none is."""

EARLY = 0.005
"""s that a frame may be early: half of the time between two readings, so that the rate is kept on average."""


class PadReading(msgspec.Struct, frozen=True):
    """One gamepad as it was read. Axes by SDL's names, -1..1, up and right positive; buttons that are down."""

    device: int
    """Another number each time that a gamepad is plugged in."""
    axes: dict[str, float]
    buttons: frozenset[str]


class PadFrame(msgspec.Struct, frozen=True):
    """What the reader tells the screen."""

    read_at: float
    """CLOCK_MONOTONIC, s."""
    names: tuple[str, ...] = ()
    """The gamepads that fit, in the order in which they were found."""
    chosen: int = 0
    """The one of them that drives."""
    held: bool = False
    """Its dead-man button is down."""
    uncentred: bool = False
    """The sticks were not in their centre when the dead-man button went down: they must be there before they drive."""
    throttle: float = 0.0
    steering: float = 0.0
    flight: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """Forward, turn, side and climb, for what flies."""
    buttons: tuple[str, ...] = ()
    """Its other buttons that are down and have an action."""

    @property
    def name(self) -> str:
        """The gamepad that drives; "" if there is none."""
        return self.names[self.chosen] if self.names else ""

    @property
    def active(self) -> bool:
        """A button is down."""
        return self.held or bool(self.buttons)


def shape(value: float, dead_zone: float, expo: float) -> float:
    """Return the demand of a stick: 0 in the dead zone, and from its edge without a step to 1."""
    if not math.isfinite(value):
        return 0.0
    size = min(1.0, max(0.0, (abs(value) - dead_zone) / (1.0 - dead_zone)))
    return math.copysign((1.0 - expo) * size + expo * size**3, value) if size else 0.0


class PadCore:
    """One mapping, and the gamepad that drives. Times are of one monotonic clock, s."""

    def __init__(self, mapping: PadMapping) -> None:
        self._mapping = mapping
        self._frame = PadFrame(-math.inf)
        self._device: int | None = None
        self._spent = True
        """The dead-man button must be released first: it was down when this gamepad was chosen."""
        self._centred = self._flight_centred = False

    def update(self, names: tuple[str, ...], chosen: int, reading: PadReading | None, now: float) -> PadFrame | None:
        """Handle the readings of the gamepad that drives. Returns the frame that is due, None if none is."""
        device = None if reading is None else reading.device
        if device != self._device:
            self._device, self._spent = device, True
        frame = PadFrame(now, names, chosen) if reading is None else self._read(names, chosen, reading, now)
        period = HELD_PERIOD if frame.active else IDLE_PERIOD
        if _essence(frame) == _essence(self._frame) and now - self._frame.read_at < period - EARLY:
            return None
        self._frame = frame
        return frame

    def _read(self, names: tuple[str, ...], chosen: int, reading: PadReading, now: float) -> PadFrame:
        throttle, steering = self._axis(reading, self._mapping.throttle), self._axis(reading, self._mapping.steering)
        forward, turn, side, climb = (self._axis(reading, name) for name in FLIGHT_MODES[self._mapping.flight])
        flight = forward, turn, side, climb
        down = self._mapping.deadman in reading.buttons
        self._spent = self._spent and down
        held = down and not self._spent
        self._centred = held and (self._centred or not (throttle or steering))
        self._flight_centred = held and (self._flight_centred or not any(flight))
        return PadFrame(
            now,
            names,
            chosen,
            held=held,
            uncentred=held and not self._centred,
            throttle=throttle if self._centred else 0.0,
            steering=steering if self._centred else 0.0,
            flight=flight if self._flight_centred else (0.0, 0.0, 0.0, 0.0),
            buttons=tuple(sorted(name for name in reading.buttons if name in self._mapping.buttons)),
        )

    def _axis(self, reading: PadReading, name: str) -> float:
        plain = name.removeprefix("-")
        if plain == "triggers":
            value = reading.axes.get("righttrigger", 0.0) - reading.axes.get("lefttrigger", 0.0)
        else:
            value = reading.axes.get(plain, 0.0)
        return round(shape(-value if name[0] == "-" else value, self._mapping.dead_zone, self._mapping.expo), 2)


def _essence(frame: PadFrame) -> tuple[object, ...]:
    """Return what is told at once. A stick that moves on only changes the next frame, or it would flood slow links."""
    moves = bool(frame.throttle or frame.steering or any(frame.flight))
    return frame.names, frame.chosen, frame.held, frame.uncentred, frame.buttons, moves
