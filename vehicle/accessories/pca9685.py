"""A servo on a channel of a PCA9685 board, which may also drive motors: the driver changes its own channel only.

A chip that is set up already, for example by the motors, is not set up again. A chip that has lost its power meanwhile
is a fault that needs a restart of the vehicle, because setting up the chip stops and starts all its channels.
"""

from __future__ import annotations

from vehicle.hardware.i2c import Bus
from vehicle.motors import MotorError
from vehicle.motors.pca9685_board import BoardSettings, Number, Pca9685Board
from vehicle.motors.settings import channel_name


class Pca9685ServoSettings(BoardSettings, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A channel of a board. All users of a board must have the same settings for it."""

    channel: Number
    """Channel of the board, 0 to 15."""

    @property
    def taken(self) -> list[str]:
        """The channel by name."""
        return [channel_name(self.channel, self.chip)]


class Pca9685Servo:
    """Fits `vehicle.accessories.Accessory`. After closing, the chip continues its last pulses."""

    Settings = Pca9685ServoSettings

    def __init__(self, settings: Pca9685ServoSettings, value: int, *, bus: Bus | None = None) -> None:
        """Set up the board if needed and output `value`. Raises MotorError."""
        self._channel = settings.channel
        self._board = Pca9685Board(settings, bus)
        try:
            self._board.retry(lambda: self._board.stop(self._channel))
            self._board.retry(self._board.set_up)
            self._board.retry(lambda: self._write(value))
        except BaseException:
            self._board.close()
            raise

    def set(self, value: int) -> None:
        """Output a pulse in one transfer, after checking that the chip is still set up. Raises MotorError."""
        try:
            self._write(value)
        except OSError as error:
            raise MotorError(self._board.describe(error)) from error

    def close(self) -> None:
        """Close the bus."""
        self._board.close()

    def _write(self, value: int) -> None:
        if not self._board.ready:
            raise MotorError("PCA9685: it has lost its power; restart the vehicle")
        if value:
            self._board.set_pulse(self._channel, value * 1e-6)
        else:
            self._board.stop(self._channel)
