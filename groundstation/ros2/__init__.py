"""A ROS 2 node over Zenoh, without ROS: the session, what it publishes, takes and serves (extra "ros").

node.py   the node: topics and services by name, in the event loop
router.py the router of its session: a locator, or a file
wire.py   the session with the router, in threads of Zenoh
"""
