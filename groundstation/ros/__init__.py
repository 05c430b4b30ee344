"""ROS without ROS: its messages as demands, and telemetry as its standard messages. No socket, no clock.

demand.py    a Twist or a word of the article as Axes
sources.py   which publisher drives, and for how long its demand stands
vehicle.py   messages of MAVLink as values of standard messages, for `export --mcap`, ROS 1 and ROS 2
frames.py    coordinates: north-east-down to east-north-up

To add or change:
- a standard message of ROS, in an export and on the topics of a node: `groundstation/ros/vehicle.py`, `ROWS`.
- a word that drives on /command of ROS: `groundstation/ros/demand.py`, `WORDS`.
"""
