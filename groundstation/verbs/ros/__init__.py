"""Verbs that connect a vehicle to ROS 1 and ROS 2."""
