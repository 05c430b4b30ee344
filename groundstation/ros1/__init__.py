"""A node of ROS 1, with the rospy that Debian or ROS Noetic has installed for the system's Python.

node.py      the node: a script for that Python, which imports rospy and nothing of this project
process.py   starts it, reads what its topics bring, and gives it what to publish
"""
