"""Basicmicro RoboClaw (two motors) in packet serial mode, over UART or USB, with S1 and S2 set to packet serial.

The controller stops both motors after its serial timeout without a frame. The timeout stops the wheels when this
process is killed, so no motor is enabled before the timeout was set and read back.
Frames as in Basicmicro's user manual, "Packet Serial": address, command, data, CRC16; the reply to a valid one is 0xFF.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Annotated

import msgspec
from fastcrc.crc16 import xmodem

from vehicle.motors import check_throttles
from vehicle.motors.serial_controller import SerialController, SerialSettings

SET_TIMEOUT, READ_TIMEOUT, READ_VERSION, DRIVE_BOTH = 14, 15, 21, 34
ACK = 0xFF
FULL = 32767
"""Duty of 100 %."""
LONGEST = 52
"""Bytes of the longest reply: a version of 48 characters with its terminator and CRC."""
TRIES = 3


class RoboClawSettings(SerialSettings, frozen=True, forbid_unknown_fields=True):
    """One RoboClaw: M1 is the left motor, M2 the right one."""

    baud: Annotated[int, msgspec.Meta(ge=2400, le=1_000_000)] = 38_400
    """Baud rate, as set in the controller; ignored over USB."""
    address: Annotated[int, msgspec.Meta(ge=0x80, le=0x87)] = 0x80
    timeout: Annotated[float, msgspec.Meta(ge=0.1, le=0.5)] = 0.3
    """s without a frame until the controller stops, in steps of 0.1. Longer than the 0.02 s between writes, shorter
    than half a second, in which a metre is driven."""
    reply_time: Annotated[float, msgspec.Meta(ge=0.01, le=0.05)] = 0.02
    """s that a reply may take. Not less than 0.01 s, after which the controller discards an incomplete frame."""


class RoboClawMotors:
    """Fits `vehicle.motors.Motors`. `set` does not wait for its reply: the next `set` reads it."""

    Settings = RoboClawSettings

    def __init__(self, settings: RoboClawSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        """Open the port and stop the motors. Raises MotorError if no RoboClaw responds."""
        self.count = 2
        self.enabled = False
        self._settings = settings
        name = f"RoboClaw 0x{settings.address:02x}"
        self._controller = SerialController(name, settings.port, settings.baud, settings.timeout, clock)
        self.port = self._controller.port
        self._unanswered = 0
        self._tries = TRIES
        self._controller.open(self.disable)

    def enable(self) -> None:
        """Enable the motors. Raises MotorError if the controller's timeout cannot be set and read back."""
        if self.enabled:
            return
        self._send_acknowledged(DRIVE_BOTH, _duties((0.0, 0.0)))
        self.prove()  # again: the setting is lost with the controller's power
        self._controller.timeout_sent()
        self.enabled = True

    def prove(self) -> None:
        """Set the controller's timeout and read it back. Raises MotorError."""
        wanted = self._controller.timeout_tenths
        self._send_acknowledged(SET_TIMEOUT, bytes([wanted]))
        found = self._query(READ_TIMEOUT, lambda data: len(data) == 1)[0]
        if found != wanted:
            raise self._controller.build_error(f"its serial timeout is {found / 10:g} s, not {wanted / 10:g} s as set")

    def disable(self) -> None:
        """Set duty 0 on both motors and wait for the acknowledgement. Raises MotorError."""
        self.enabled = False
        self._send_acknowledged(DRIVE_BOTH, _duties((0.0, 0.0)))

    def set(self, throttles: Sequence[float]) -> None:
        """Send both duties in one frame; no effect while disabled."""
        values = check_throttles(throttles, self.count)
        if not self.enabled:
            return
        with self._controller.tolerate_errors() as now:
            self._collect(now)
            self._send(DRIVE_BOTH, _duties(values))
            if self._controller.is_timeout_due(now):
                self._send(SET_TIMEOUT, bytes([self._controller.timeout_tenths]))

    def version(self) -> str:
        """Return model and firmware. Waits for the reply, so not for the control loop. Raises MotorError."""
        return self._query(READ_VERSION, lambda data: data.endswith(b"\0")).decode("ascii", "replace").strip("\n\0")

    def close(self) -> None:
        """Disable the motors, then close the port."""
        self._controller.close(self.disable)

    def _collect(self, now: float) -> None:
        """Read the replies to earlier frames. Any reply means that the controller accepts frames."""
        replies = self.port.read()
        if ACK in replies:
            self._unanswered = max(0, self._unanswered - replies.count(ACK))
            self._controller.error_budget.reset()
        elif self._unanswered:
            self._controller.error_budget.check_silence(self._controller.describe("no reply"), now)

    def _send_acknowledged(self, command: int, data: bytes) -> None:
        """Send a command until it and all earlier ones are acknowledged. Raises MotorError."""
        reason = ""
        for _ in range(self._tries):
            try:
                self._connect()
                self._send(command, data)
                if self._all_acknowledged():
                    self._tries = TRIES
                    return
                reason = "no reply: is it on, in packet serial mode, with this address and baud rate?"
                self._discard_replies()
            except OSError as error:
                reason = str(error)
        self._tries = 1  # a controller that does not respond is tried in each cycle, which must not delay the loop
        raise self._controller.build_error(reason)

    def _query(self, command: int, complete: Callable[[bytes], bool]) -> bytes:
        """Return the data of a reply that is `complete` and has a valid CRC. Raises MotorError."""
        reason = ""
        request = bytes([self._settings.address, command])
        for _ in range(self._tries):
            try:
                self._connect()
                self._discard_replies()
                self.port.write(request)
                reply = self._read_reply(complete)
                if complete(reply[:-2]) and _crc_matches(request + reply):
                    return reply[:-2]
                reason = f"invalid reply, {reply.hex(' ') or 'none'}"
            except OSError as error:
                reason = str(error)
        raise self._controller.build_error(reason)

    def _connect(self) -> None:
        if self.port.open():
            self._unanswered = 0

    def _discard_replies(self) -> None:
        """Discard pending replies: the controller has dropped an incomplete frame after the time waited for it."""
        self._unanswered = 0
        self.port.discard_input()

    def _send(self, command: int, data: bytes) -> None:
        frame = bytes([self._settings.address, command]) + data
        self.port.write(frame + xmodem(frame).to_bytes(2, "big"))
        self._unanswered += 1

    def _all_acknowledged(self) -> bool:
        while self._unanswered:
            replies = self.port.read(self._settings.reply_time)
            if not replies:
                return False
            self._unanswered = max(0, self._unanswered - replies.count(ACK))
        return True

    def _read_reply(self, complete: Callable[[bytes], bool]) -> bytes:
        reply = b""
        while not complete(reply[:-2]) and len(reply) < LONGEST:
            more = self.port.read(self._settings.reply_time)
            if not more:
                break
            reply += more
        return reply


def _duties(throttles: Sequence[float]) -> bytes:
    return b"".join(round(throttle * FULL).to_bytes(2, "big", signed=True) for throttle in throttles)


def _crc_matches(frame: bytes) -> bool:
    return xmodem(frame[:-2]) == int.from_bytes(frame[-2:], "big")
