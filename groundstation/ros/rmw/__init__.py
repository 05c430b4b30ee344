"""What rmw_zenoh_cpp, the Zenoh middleware of ROS 2, puts on the wire: names, tokens and attachments.

https://github.com/ros2/rmw_zenoh/blob/rolling/docs/design.md
"""
