"""Gamepads through SDL 2 (packages PySDL2 and pysdl2-dll, extra [gamepad]): plugged in, unplugged, and read.

The only module that imports sdl2. SDL needs no window: the events of gamepads come without a video driver.
"""

from __future__ import annotations

import ctypes
import os
import warnings
from typing import Any

import msgspec

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # PySDL2 warns that it uses the library of pysdl2-dll, which it should
    import sdl2

from groundstation.input.pad import PadReading
from groundstation.input.pad_mapping import BUTTONS

_FULL = 32767.0
_AXES = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")
_DOWN_IS_POSITIVE = ("lefty", "righty")
"""SDL counts these axes downwards."""

HINTS = {b"SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS": b"1", b"SDL_NO_SIGNAL_HANDLERS": b"1"}


class SdlError(RuntimeError):
    """SDL does not start; the message is one line for the user."""


class Plugged(msgspec.Struct, frozen=True):
    """One gamepad that is plugged in."""

    number: int
    """SDL's instance id: another one each time that it is plugged in."""
    name: str
    handle: Any


class Gamepads:
    """The gamepads of this machine that SDL knows, in the order in which they were plugged in."""

    def __init__(self) -> None:
        """Start SDL without video. Raises SdlError."""
        for name, value in HINTS.items():
            sdl2.SDL_SetHint(name, value)
        if sdl2.SDL_Init(sdl2.SDL_INIT_GAMECONTROLLER | sdl2.SDL_INIT_JOYSTICK) != 0:
            raise SdlError(f"SDL: {sdl2.SDL_GetError().decode(errors='replace')}")
        self._event = sdl2.SDL_Event()
        self._devices: list[Plugged] = []

    @property
    def plugged(self) -> tuple[Plugged, ...]:
        """All of them."""
        return tuple(self._devices)

    def poll(self) -> None:
        """Read the events of the devices, and those that were plugged in or unplugged."""
        while sdl2.SDL_PollEvent(ctypes.byref(self._event)):
            if self._event.type == sdl2.SDL_CONTROLLERDEVICEADDED:
                self._open(self._event.cdevice.which)
        self._devices = [device for device in self._devices if self._is_attached(device)]

    def read(self, number: int) -> PadReading:
        """Return the state of the one with this number."""
        handle = next(device.handle for device in self._devices if device.number == number)
        buttons = (sdl2.SDL_GameControllerGetButtonFromString(name.encode()) for name in BUTTONS)
        down = [bool(sdl2.SDL_GameControllerGetButton(handle, button)) for button in buttons]
        pressed = frozenset(name for name, is_down in zip(BUTTONS, down, strict=True) if is_down)
        return PadReading(number, {name: _axis(handle, name) for name in _AXES}, pressed)

    def _open(self, index: int) -> None:
        handle = sdl2.SDL_GameControllerOpen(index)
        if not handle:
            return
        number = sdl2.SDL_JoystickInstanceID(sdl2.SDL_GameControllerGetJoystick(handle))
        if all(device.number != number for device in self._devices):  # SDL reports those of the start twice
            name = (sdl2.SDL_GameControllerName(handle) or b"gamepad").decode(errors="replace")
            self._devices.append(Plugged(number, name, handle))

    @staticmethod
    def _is_attached(device: Plugged) -> bool:
        if sdl2.SDL_GameControllerGetAttached(device.handle):
            return True
        sdl2.SDL_GameControllerClose(device.handle)
        return False


def _axis(handle: Any, name: str) -> float:
    axis = sdl2.SDL_GameControllerGetAxisFromString(name.encode())
    value: float = sdl2.SDL_GameControllerGetAxis(handle, axis) / _FULL
    return -value if name in _DOWN_IS_POSITIVE else value
