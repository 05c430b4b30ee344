"""`groundstation ros2`: the vehicle as a node of ROS 2 over rmw_zenoh, without an installation of ROS.

Messages of /cmd_vel and /command drive by the rules of every driver (ros_driver.py), telemetry is published as standard
messages, and parameters are those of the vehicle. A service that arms is there on request only. It runs until Ctrl-C.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import time
from typing import TYPE_CHECKING, Any

from dialects import messages as m
from groundstation.ros.diagnostics import diagnostics, log_line
from groundstation.ros.rmw.names import name_fault, namespace_fault
from groundstation.ros.vehicle import ODOMETRY, RosVehicle, transforms
from groundstation.verbs.common.arguments import Argument
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.ros.ros_driver import RosDriver
from groundstation.verbs.ros.ros_rates import RATE, request_rates
from groundstation.verbs.ros.ros_scale import ARGUMENTS as SCALE_ARGUMENTS
from groundstation.verbs.ros.ros_scale import learn_scale
from groundstation.verbs.session.session import VerbSession
from link.core import Received
from link.runtime.install_hint import install_command

if TYPE_CHECKING:
    from groundstation.ros.types import RosTypes
    from groundstation.ros2.node import Ros2Node

DOMAIN_VARIABLE = "ROS_DOMAIN_ID"
LAST_DOMAIN = 232
"""Of ROS 2, where DDS needs a port for each."""
DEFAULT_ROUTER = "tcp/localhost:7447"
"""Where rmw_zenoh_cpp looks for its router."""
CMD_VEL, TWIST_TYPE, STAMPED_TYPE = "cmd_vel", "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
COMMAND, WORD_TYPE = "command", "std_msgs/msg/String"
PUBLISHED = {
    "odom": ODOMETRY,
    "imu": "sensor_msgs/msg/Imu",
    "fix": "sensor_msgs/msg/NavSatFix",
    "battery_state": "sensor_msgs/msg/BatteryState",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/rosout": "rcl_interfaces/msg/Log",
}
"""Topic -> its type. One without a slash is in the namespace of the node."""
TRANSFORMS, TRANSFORM_TYPE = "/tf", "tf2_msgs/msg/TFMessage"
DIAGNOSTICS_PERIOD = 1.0
"""s"""


def domain(text: str) -> int:
    """Parse a ROS domain. Raises ArgumentTypeError."""
    if not (text.isascii() and text.isdecimal() and int(text) <= LAST_DOMAIN):
        raise argparse.ArgumentTypeError(f"{text!r} is not a domain from 0 to {LAST_DOMAIN}")
    return int(text)


def check(options: argparse.Namespace) -> None:
    """Check what is installed, and the names. Raises VerbError."""
    try:
        from groundstation.ros2.node import Ros2Node  # noqa: F401
        from groundstation.ros2.router import load_router
    except ImportError as error:
        text = f"ROS 2 needs the package {error.name}, which is not installed: {install_command('ros')}"
        raise VerbError(ExitCode.USAGE, text) from None
    fault = options.node and name_fault(options.node)
    fault = fault or namespace_fault(options.namespace)
    if fault:
        raise VerbError(ExitCode.USAGE, fault)
    if options.domain is None:
        try:
            options.domain = domain(os.environ.get(DOMAIN_VARIABLE) or "0")
        except argparse.ArgumentTypeError as error:
            raise VerbError(ExitCode.USAGE, f"{DOMAIN_VARIABLE}: {error}") from None
    options.router = load_router(options.router)
    options.types = _prepare_types()


def _prepare_types() -> RosTypes:
    """Return the types of the node. It takes half a second, in which a program that drives would stand still."""
    from groundstation.ros.services import SERVICES
    from groundstation.ros.types import RosTypes

    types = RosTypes()
    for name, parts in SERVICES.items():
        types.register_service(name, *parts)
    for kind in (*PUBLISHED.values(), TRANSFORM_TYPE, TWIST_TYPE, STAMPED_TYPE, WORD_TYPE, *SERVICES):
        types.prepare(kind)
    return types


ARGUMENTS: tuple[Argument, ...] = (
    *SCALE_ARGUMENTS,
    ("--arm-service", {"action": "store_true", "help": "offer the service ~/arm: every node of this ROS may arm"}),
    ("--router", {"default": DEFAULT_ROUTER, "metavar": "LOCATOR|FILE.json5",
                  "help": f"the Zenoh router of ROS (default: {DEFAULT_ROUTER})"}),
    ("--domain", {"type": domain, "metavar": "N", "help": f"ROS domain (default: {DOMAIN_VARIABLE}, else 0)"}),
    ("--namespace", {"default": "/", "metavar": "/NAME", "help": "before all its topics and services"}),
    ("--node", {"metavar": "NAME", "help": "name of the node (default: mavhelm_ and the system id)"}),
    RATE,
    ("--tf", {"action": "store_true", "help": "publish the transform from odom to base_link, too"}),
)  # fmt: skip


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Be the node until the program is interrupted."""
    await session.need_only_vehicle(options.vehicle)
    driver = RosDriver(session, await learn_scale(session, options), output)
    node = _build(session, driver, options)
    if options.arm:
        armed, text = await driver.set_armed(True, options.wait)
        if not armed:
            raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name}: {text}")
    publishing = asyncio.ensure_future(_publish(session, driver, node, options))
    try:
        node.start()
        await driver.run()
    finally:
        publishing.cancel()
        try:
            await driver.leave()
        finally:
            node.close()
    return ExitCode.DONE


def _build(session: VerbSession, driver: RosDriver, options: argparse.Namespace) -> Ros2Node:
    """Return the node with its topics and services."""
    from groundstation.ros2.node import NodeNames, Ros2Node
    from groundstation.verbs.ros.ros2_params import add_parameter_services

    name = options.node or f"mavhelm_{session.vehicle.system}"
    names = NodeNames(options.router, options.domain, options.namespace, name)
    node = Ros2Node(
        names, driver.note, lambda topic, gid: driver.remove((topic.rpartition("/")[2], gid)), options.types
    )
    for topic, kind in PUBLISHED.items():
        node.add_publisher(topic, kind)
    if options.tf:
        node.add_publisher(TRANSFORMS, TRANSFORM_TYPE)

    def take_twist(gid: bytes, message: Any) -> None:
        driver.push_twist((CMD_VEL, gid), message.linear.x, message.angular.z)

    def take_stamped(gid: bytes, message: Any) -> None:
        take_twist(gid, message.twist)

    def take_word(gid: bytes, message: Any) -> None:
        driver.push_word((COMMAND, gid), message.data)

    async def arm(request: Any) -> dict[str, Any]:
        done, text = await driver.set_armed(bool(request.data), options.wait)
        return {"success": done, "message": text}

    node.add_subscription(CMD_VEL, TWIST_TYPE, take_twist)
    node.add_subscription(CMD_VEL, STAMPED_TYPE, take_stamped)
    node.add_subscription(COMMAND, WORD_TYPE, take_word)
    if options.arm_service:
        node.add_service("~/arm", "std_srvs/srv/SetBool", arm)
    add_parameter_services(node, session)
    return node


async def _publish(session: VerbSession, driver: RosDriver, node: Ros2Node, options: argparse.Namespace) -> None:
    """Publish what the vehicle reports, and its diagnostics."""
    session.core.taps.append(_tap(session, node, tf=options.tf))
    await request_rates(session, options.rate)
    while True:
        view = session.vehicle.build_view(session.now)
        node.publish("/diagnostics", diagnostics(view, driver.engaged, _unix_time()))
        await asyncio.sleep(DIAGNOSTICS_PERIOD)


def _tap(session: VerbSession, node: Ros2Node, *, tf: bool) -> Any:
    """Return what takes each message that arrives, and publishes what it makes."""
    state = session.vehicle
    vehicle = RosVehicle(state.component)

    def take(received: Received, now: float) -> None:
        if (received.system, received.component) != (state.system, state.component):
            return
        if isinstance(received.message, m.StatusText):
            line = log_line(received.message.text, received.message.severity, node.names.name, _unix_time())
            node.publish("/rosout", line)
        made = vehicle.take(received.message, _unix_time())
        if made is not None:
            topic, kind, values = made
            node.publish(topic, values)
            if tf and kind == ODOMETRY:
                node.publish(TRANSFORMS, transforms(values))

    return take


def _unix_time() -> int:
    return time.time_ns() // 1000
