"""Messages of ROS that demand motion, as Axes: geometry_msgs/Twist, and the words and keys of a std_msgs/String.

https://www.ros.org/reps/rep-0103.html: x is forward, and a positive turn is counterclockwise, to the left.
"""

from __future__ import annotations

import math

import msgspec

from dialects.axes import NEUTRAL, Axes

DEFAULT_SPEED, DEFAULT_TURN, DEFAULT_CLIMB = 1.0, 1.0, 1.0
"""m/s, rad/s and m/s that are full deflection, unless the user says otherwise."""

FORWARD, BACKWARD = Axes(throttle=1.0), Axes(throttle=-1.0)
LEFT, RIGHT = Axes(steering=-1.0), Axes(steering=1.0)

WORDS: dict[str, Axes] = {
    "forward": FORWARD, "backward": BACKWARD, "left": LEFT, "right": RIGHT, "stop": NEUTRAL,
    "i": FORWARD, ",": BACKWARD, "j": LEFT, "l": RIGHT, "k": NEUTRAL,
}  # fmt: skip
"""Data of a String on /command -> its direction. The words are those of drive_node in the article, the keys those of
its command_node and of teleop_twist_keyboard."""

LONGEST_WORD = 16
"""Characters of unknown data that are shown."""


class RefusedDemandError(ValueError):
    """A message is not a demand; the text says why, in one line."""


class Scale(msgspec.Struct, frozen=True):
    """What full deflection is, and how much of it a word demands."""

    speed: float = DEFAULT_SPEED
    """m/s of a Twist, > 0."""
    turn: float = DEFAULT_TURN
    """rad/s of a Twist, > 0."""
    climb: float = DEFAULT_CLIMB
    """m/s up of a Twist, > 0."""
    flies: bool = False
    """linear.y and linear.z count."""
    word_throttle: float = 0.6
    """0 to 1: of `forward` and `backward`, as of the article's car."""
    word_steering: float = 0.4
    """0 to 1: of `left` and `right`."""

    def of_twist(self, linear: tuple[float, float, float], angular_z: float) -> Axes:
        """Return the demand of a Twist in m/s and rad/s; more than full deflection is full deflection.

        `linear`: forward, left, up; the last two count for what flies. Raises RefusedDemandError for what is not a
        finite number.
        """
        x, y, z = linear if self.flies else (linear[0], 0.0, 0.0)
        if not all(map(math.isfinite, (x, y, z, angular_z))):
            sides = f", linear.y {y:g}, linear.z {z:g}" if self.flies else ""
            raise RefusedDemandError(f"linear.x {x:g}{sides}, angular.z {angular_z:g}: not finite")
        turn = _clamp(-angular_z / self.turn)
        return Axes(_clamp(x / self.speed), turn, _clamp(-y / self.speed), _clamp(z / self.climb))

    def of_word(self, data: str) -> Axes:
        """Return the demand of the data of a String. Raises RefusedDemandError for an unknown word."""
        axes = WORDS.get(data.strip().lower() or data)
        if axes is None:
            raise RefusedDemandError(f"{data[:LONGEST_WORD]!r} is none of {', '.join(WORDS)}")
        return Axes(axes.throttle * self.word_throttle, axes.steering * self.word_steering)


def _clamp(value: float) -> float:
    return max(-1.0, min(1.0, value)) + 0.0
