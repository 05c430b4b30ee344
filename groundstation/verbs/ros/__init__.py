"""Verbs that connect a vehicle to ROS 1 and ROS 2.

To add or change:
- a topic or service of the ROS 2 node: `groundstation/verbs/ros/ros2.py`, `PUBLISHED` and `_build`; the definition of
  a service: `groundstation/ros/services.py`.
"""
