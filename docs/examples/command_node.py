"""A node that publishes words for keys to /command, as the one of the Circuit Cellar article: a script for rospy.

It publishes its last word again in each round, which takes up to 0.7 s without a key.
"""

from __future__ import annotations

import os
import select
import sys
import termios
import tty
from contextlib import suppress
from typing import Any

import rospy
from std_msgs.msg import String

WORDS = {"i": "forward", "j": "left", "k": "stop", "l": "right", ",": "backward"}
CTRL_C = "\x03"


def read_key(settings: list[Any]) -> str:
    """Return the key that is pressed within 0.6 s, or ''."""
    tty.setraw(sys.stdin.fileno(), termios.TCSADRAIN)  # keeps what was typed meanwhile
    ready, _, _ = select.select([sys.stdin], [], [], 0.6)
    key = os.read(sys.stdin.fileno(), 1).decode(errors="replace") if ready else ""
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
    return key


def main() -> None:
    """Publish until Ctrl-C."""
    settings = termios.tcgetattr(sys.stdin)
    publisher = rospy.Publisher("command", String, queue_size=10)
    rospy.init_node("command_node")
    print("i forward, j left, k stop, l right, comma backward; Ctrl-C ends")
    rate = rospy.Rate(10)
    command = "stop"
    while not rospy.is_shutdown():
        key = read_key(settings)
        if key == CTRL_C:
            break
        command = WORDS.get(key, command)
        publisher.publish(command)
        with suppress(rospy.ROSInterruptException):  # Ctrl-C while no key is read
            rate.sleep()


if __name__ == "__main__":
    main()
