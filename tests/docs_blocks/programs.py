"""The table of programs that stay until they are ended, and of questions that programs ask.

A command that is in no row must end by itself, with exit code 0.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

CTRL_C, CTRL_Q = "\x03", "\x11"


class Stays(NamedTuple):
    """A program that runs until it is ended."""

    command: str
    """Regular expression, from its begin."""
    shows: str
    """Regular expression of what it prints when it works."""
    ends: str = CTRL_C
    """Keys that end it."""
    codes: tuple[int, ...] = (0,)
    """Exit codes with which it may end then."""


STAYS = (
    Stays(r"mavhelm (?:attach|replay)\b", "F1.*F10|Drive", CTRL_Q),
    Stays(r"mavhelm learn$", r"Lesson 1 .* task 1", CTRL_Q),
    Stays(r"mavhelm keys\b", "q", "q"),
    Stays(r"mavhelm video (?!.*--snapshot)", "age|NO PICTURE", "q"),
    Stays(r"mavhelm serve --web\b", r"http://127\.0\.0\.1:\d+/\?token=\w+"),
    Stays(r"mavhelm serve --headless\b", r"station \d+ on "),
    Stays(r"mavhelm ros1\b", "publish to command or cmd_vel", codes=(130,)),
    Stays(r"mavhelm ros2\b", "node /mavhelm_1 at", codes=(130,)),
    Stays(r"mavhelm watch (?!.*--(?:until|for|count)\b)", r"\d", codes=(0, 130)),
    Stays(r"mavhelm --plain\b", "link up", codes=(130,)),
    Stays(r"mavhelm(?! (?:[a-z]+[0-9]?)(?: |$))", "Drive", CTRL_Q),
    Stays(r"mavhelm control give\b", "waiting until", codes=(130,)),
    Stays(r"(?:until )?\S*mavhelm vehicle (?=--|udp)|GPIOZERO", "vehicle: ready"),
    Stays(r"mavhelm bridge router\b", "bridge router: ready"),
    Stays(r"mavhelm bridge (?=serial:|udp|tcp|zenoh:)", r'ready.*"system": 1,|\n *1 +1 +serial:'),
    Stays(r"python own_sensor.py", "water to udpout"),
    Stays(r"roscore\b", "started core service"),
    Stays(r"rostopic echo\b", "---", codes=(0, 130)),
    Stays(r"rostopic pub -r\b", "", codes=(0, 130)),
    Stays(r"/usr/bin/python3 docs/examples/command_node.py", "Ctrl-C ends"),
)


NEEDS = (
    (r"roscore\b|mavhelm ros1\b|/usr/bin/python3 docs/examples/command_node", "roscore"),
    (r"rostopic\b", "rostopic"),
    (r"ffmpeg\b|mavhelm video\b", "ffmpeg"),
)
"""Begin of a command -> a program that a laptop may lack: there it is left out."""


class Asks(NamedTuple):
    """A program that asks."""

    command: str
    prompt: str
    answer: Callable[[str], str]
    """Called with all that was printed on the page so far."""


def words_of(printed: str) -> str:
    """Return the 24 words of the key that was printed last."""
    return " ".join(re.findall(r"(?:\b[a-z]{3,8}\b\s+){24}", printed)[-1].split()) + "\n"


ASKS = (
    Asks(r"mavhelm sign install \S+ --words", "word 1 of 24", words_of),
    Asks(r"\S*mavhelm vehicle motor-test\b", r"\?", lambda _: "y\n"),
)


def find_staying(command: str) -> Stays | None:
    """Return the row of a command."""
    return next((row for row in STAYS if re.match(row.command, command)), None)


def find_asking(command: str) -> Asks | None:
    """Return the row of a command."""
    return next((row for row in ASKS if re.match(row.command, command)), None)
