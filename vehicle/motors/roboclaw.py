"""Basicmicro RoboClaw (two motors) in packet serial mode, over UART or USB; S1 and S2 in their packet functions.

The controller stops both motors when it has heard nothing for its serial timeout. That is what stops the wheels when
this process is killed, so no motor is enabled before the timeout was set and read back.
Frames as in Basicmicro's user manual, "Packet Serial": address, command, data, CRC16; 0xFF for one that was taken.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from typing import Annotated

import msgspec
from fastcrc.crc16 import xmodem

from vehicle.motors import check_throttles
from vehicle.motors.serial_controller import SerialController, tenths
from vehicle.motors.settings import port_name, uart_pins

SET_TIMEOUT, READ_TIMEOUT, READ_VERSION, DRIVE_BOTH = 14, 15, 21, 34
ACK = 0xFF
FULL = 32767
"""Duty of 100 %."""
LONGEST = 52
"""bytes of the longest reply: a version of 48 with its end and CRC."""
TRIES = 3


class RoboClawSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One RoboClaw: M1 is the left motor, M2 the right one."""

    port: str
    """/dev/serial0, /dev/ttyACM0, or better a name from /dev/serial/by-id."""
    baud: Annotated[int, msgspec.Meta(ge=2400, le=1_000_000)] = 38_400
    """As set in the controller; over USB without meaning."""
    address: Annotated[int, msgspec.Meta(ge=0x80, le=0x87)] = 0x80
    timeout: Annotated[float, msgspec.Meta(ge=0.1, le=0.5)] = 0.3
    """s of silence until the controller stops; steps of 0.1. Longer than the 0.02 s between writes, shorter than
    half a second, in which a metre is driven."""
    reply_time: Annotated[float, msgspec.Meta(ge=0.01, le=0.05)] = 0.02
    """s that a reply may take. The controller throws half a frame away after 0.01 s, so not less."""

    @property
    def taken(self) -> list[str]:
        """The port."""
        return [port_name(self.port)]

    @property
    def pins_nearby(self) -> tuple[int, ...]:
        """Where it may come out."""
        return uart_pins(self.port)


class RoboClawMotors:
    """Fits `vehicle.motors.Motors`. `set` does not wait for its reply: the next `set` looks for it."""

    Settings = RoboClawSettings

    def __init__(self, settings: RoboClawSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        """Raises MotorError where no RoboClaw answers."""
        self.count = 2
        self.enabled = False
        self._settings = settings
        self._tenths = tenths(settings.timeout)
        self._controller = SerialController(f"RoboClaw 0x{settings.address:02x}", settings.port, settings.baud, clock)
        self.port = self._controller.port
        self._unanswered = 0
        self._tries = TRIES
        with contextlib.ExitStack() as opened:
            opened.callback(self.port.close)
            self.disable()
            opened.pop_all()

    def enable(self) -> None:
        """Raises MotorError where the controller's timeout cannot be set and read back."""
        if self.enabled:
            return
        self._send_acknowledged(DRIVE_BOTH, _duties((0.0, 0.0)))
        self.prove()  # again: it forgets with its power
        self._controller.timeout_sent()
        self.enabled = True

    def prove(self) -> None:
        """Set the controller's timeout and read it back. Raises MotorError."""
        self._send_acknowledged(SET_TIMEOUT, bytes([self._tenths]))
        found = self._query(READ_TIMEOUT, lambda data: len(data) == 1)[0]
        if found != self._tenths:
            raise self._controller.build_error(
                f"its serial timeout is {found / 10:g} s and not {self._tenths / 10:g} s as set"
            )

    def disable(self) -> None:
        """Duty 0 on both, and the controller has said that it took it. Raises MotorError."""
        self.enabled = False
        self._send_acknowledged(DRIVE_BOTH, _duties((0.0, 0.0)))

    def set(self, throttles: Sequence[float]) -> None:
        """Both duties in one frame; nothing while disabled."""
        values = check_throttles(throttles, self.count)
        if not self.enabled:
            return
        with self._controller.tolerate_errors() as now:
            self._collect(now)
            self._send(DRIVE_BOTH, _duties(values))
            if self._controller.is_timeout_due(now):
                self._send(SET_TIMEOUT, bytes([self._tenths]))

    def version(self) -> str:
        """Model and firmware, as it calls itself. Waits for the reply: not for the control loop. Raises MotorError."""
        return self._query(READ_VERSION, lambda data: data.endswith(b"\0")).decode("ascii", "replace").strip("\n\0")

    def close(self) -> None:
        """As disabled, then the port is let go."""
        self._controller.close(self.disable)

    def _collect(self, now: float) -> None:
        """Replies to what was sent before. Any reply means that it lives and takes our frames."""
        replies = self.port.read()
        if ACK in replies:
            self._unanswered = max(0, self._unanswered - replies.count(ACK))
            self._controller.error_budget.reset()
        elif self._unanswered:
            self._controller.error_budget.check_silence(self._controller.describe("no reply"), now)

    def _send_acknowledged(self, command: int, data: bytes) -> None:
        """Send until it is acknowledged, together with all that was sent before. Raises MotorError."""
        reason = ""
        for _ in range(self._tries):
            try:
                self._connect()
                self._send(command, data)
                if self._answered():
                    self._tries = TRIES
                    return
                reason = "no reply: is it on, in packet serial mode, with this address and baud rate?"
                self._start_over()
            except OSError as error:
                reason = str(error)
        self._tries = 1  # a controller known to be dead is asked in each cycle: that must not hold the loop up
        raise self._controller.build_error(reason)

    def _query(self, command: int, complete: Callable[[bytes], bool]) -> bytes:
        """The data of a reply, once it is `complete` and its CRC is right. Raises MotorError."""
        reason = ""
        question = bytes([self._settings.address, command])
        for _ in range(self._tries):
            try:
                self._connect()
                self._start_over()
                self.port.write(question)
                reply = self._reply(complete)
                if complete(reply[:-2]) and _crc_matches(question + reply):
                    return reply[:-2]
                reason = f"a bad reply, {reply.hex(' ') or 'none'}"
            except OSError as error:
                reason = str(error)
        raise self._controller.build_error(reason)

    def _connect(self) -> None:
        if self.port.open():
            self._unanswered = 0

    def _start_over(self) -> None:
        """Forget replies that are still to come: a frame in the making is thrown away after the time waited for it."""
        self._unanswered = 0
        self.port.discard_input()

    def _send(self, command: int, data: bytes) -> None:
        frame = bytes([self._settings.address, command]) + data
        self.port.write(frame + xmodem(frame).to_bytes(2, "big"))
        self._unanswered += 1

    def _answered(self) -> bool:
        while self._unanswered:
            replies = self.port.read(self._settings.reply_time)
            if not replies:
                return False
            self._unanswered = max(0, self._unanswered - replies.count(ACK))
        return True

    def _reply(self, complete: Callable[[bytes], bool]) -> bytes:
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
