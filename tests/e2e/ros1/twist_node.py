"""A node that publishes a Twist at 10 Hz, and prints which telemetry arrives: a script for rospy."""

from __future__ import annotations

import sys
from typing import Any

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Imu, NavSatFix

TELEMETRY = {"odom": Odometry, "imu": Imu, "fix": NavSatFix, "battery_state": BatteryState}


def main() -> None:
    """Publish until the end; print a line for the first message of each topic."""
    rospy.init_node("twist_node")
    seen: set[str] = set()

    def show(message: Any, topic: str) -> None:
        if topic not in seen:
            seen.add(topic)
            sys.stdout.write(f"{topic} {message.header.frame_id}\n")  # in one piece: each topic has a thread
            sys.stdout.flush()

    for topic, kind in TELEMETRY.items():
        rospy.Subscriber(topic, kind, show, callback_args=topic)
    publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    twist = Twist()
    twist.linear.x = 0.5
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        publisher.publish(twist)
        rate.sleep()


if __name__ == "__main__":
    main()
