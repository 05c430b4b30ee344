"""The reader process with SDL's virtual gamepads plugged in, which a test operates over a socket. Run as `python -m`.

Everything but the device is real: groundstation/gamepad/reader.py runs unchanged in this process.
"""

from __future__ import annotations

import ctypes
import os
import socket
import sys
import threading

import sdl2

from groundstation.gamepad import reader
from groundstation.gamepad.sdl import Gamepads
from link.runtime.local_socket import open_socket
from tests.groundstation.gamepad.pads import SOCKET

AXES = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")


class VirtualPads:
    """Carries out the lines of a test: `plug NAME`, `unplug NAME`, `axis NAME AXIS VALUE`, `button NAME BUTTON 0|1`."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}

    def run(self, lines: socket.socket) -> None:
        """Answer each line once it is done."""
        while line := lines.recv(256).decode():
            words = line.split()
            getattr(self, f"_{words[0]}")(*words[1:])
            lines.send(line.encode())

    def _plug(self, name: str) -> None:
        wanted = sdl2.SDL_VirtualJoystickDesc()
        wanted.version, wanted.type = sdl2.SDL_VIRTUAL_JOYSTICK_DESC_VERSION, sdl2.SDL_JOYSTICK_TYPE_GAMECONTROLLER
        wanted.naxes, wanted.nbuttons, wanted.name = len(AXES), sdl2.SDL_CONTROLLER_BUTTON_MAX, name.encode()
        wanted.axis_mask, wanted.button_mask = (1 << wanted.naxes) - 1, (1 << wanted.nbuttons) - 1
        index = sdl2.SDL_JoystickAttachVirtualEx(ctypes.byref(wanted))
        self._numbers[name] = sdl2.SDL_JoystickGetDeviceInstanceID(index)

    def _unplug(self, name: str) -> None:
        number = self._numbers.pop(name)
        found = range(sdl2.SDL_NumJoysticks())
        sdl2.SDL_JoystickDetachVirtual(
            next(index for index in found if sdl2.SDL_JoystickGetDeviceInstanceID(index) == number)
        )

    def _axis(self, name: str, axis: str, value: str) -> None:
        sdl2.SDL_JoystickSetVirtualAxis(self._stick(name), AXES.index(axis), int(value))

    def _button(self, name: str, button: str, down: str) -> None:
        number = sdl2.SDL_GameControllerGetButtonFromString(button.encode())
        sdl2.SDL_JoystickSetVirtualButton(self._stick(name), number, int(down))

    def _stick(self, name: str) -> object:
        return sdl2.SDL_JoystickFromInstanceID(self._numbers[name])


class LateGamepads(Gamepads):
    """Gamepads of this machine, and the virtual ones from then on."""

    def __init__(self) -> None:
        super().__init__()
        lines = open_socket()
        lines.connect(os.environ[SOCKET])
        lines.send(str(os.getpid()).encode())
        threading.Thread(target=VirtualPads().run, args=(lines,), daemon=True).start()


if __name__ == "__main__":
    setattr(reader, "Gamepads", LateGamepads)  # noqa: B010 - the reader does not export the name
    raise SystemExit(reader.main(sys.argv[1:]))
