"""A servo at a channel of a PCA9685 board, which may be the board of the motors: it touches its own channel only.

Where the chip was set up before, by the motors for one, this sets up nothing; one that has lost its power meanwhile is
a fault that only a restart mends, because setting it up stops and starts all its channels.
"""

from __future__ import annotations

from vehicle.hardware.i2c import Bus
from vehicle.motors import MotorError
from vehicle.motors.pca9685_board import BoardSettings, Number, Pca9685Board
from vehicle.motors.settings import channel_name


class Pca9685ServoSettings(BoardSettings, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A channel of a board. What the board is must be the same for all that is at it."""

    channel: Number
    """Of the board, 0 to 15."""

    @property
    def taken(self) -> list[str]:
        """The channel."""
        return [channel_name(self.channel, self.chip)]


class Pca9685Servo:
    """Fits `vehicle.accessories.Accessory`. The chip goes on with its last pulses once it is closed."""

    Settings = Pca9685ServoSettings

    def __init__(self, settings: Pca9685ServoSettings, value: int, *, bus: Bus | None = None) -> None:
        """Raises MotorError."""
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
        """One transfer, after a look whether the chip is still set up. Raises MotorError."""
        try:
            self._write(value)
        except OSError as error:
            raise MotorError(self._board.describe(error)) from error

    def close(self) -> None:
        """Let go of the bus."""
        self._board.close()

    def _write(self, value: int) -> None:
        if not self._board.ready:
            raise MotorError("PCA9685: it has lost its power, restart the vehicle")
        if value:
            self._board.set_pulse(self._channel, value * 1e-6)
        else:
            self._board.stop(self._channel)
