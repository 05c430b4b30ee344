"""`mavhelm ros2`: the vehicle as a node of ROS 2 over rmw_zenoh, without an installation of ROS.

Messages of /cmd_vel and /command drive by the rules of every driver (ros_driver.py), telemetry is published as standard
messages, and parameters are those of the vehicle. A service that arms is there on request only. It runs until Ctrl-C.

The node, with the Zenoh library and its threads, is the companion of the verb, so that it is never in a station.
"""

from __future__ import annotations

import argparse
import asyncio
import os
from functools import partial
from itertools import count
from typing import TYPE_CHECKING, Any

from dialects import messages as m
from groundstation.ros.diagnostics import diagnostics, log_line
from groundstation.ros.freshness import MAX_LATENESS
from groundstation.ros.rmw.names import name_fault, namespace_fault
from groundstation.ros.vehicle import ODOMETRY, Values, transforms
from groundstation.verbs.common.arguments import Argument
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.ros.ros2_params import PARAMETER_SERVICES, parameter_services
from groundstation.verbs.ros.ros_driver import RosDriver
from groundstation.verbs.ros.ros_rates import RATE, publish_telemetry, request_rates, unix_time
from groundstation.verbs.ros.ros_scale import ARGUMENTS as SCALE_ARGUMENTS
from groundstation.verbs.ros.ros_scale import learn_scale
from groundstation.verbs.session.session import VerbSession
from link.core import Received
from link.runtime.install_hint import install_command

if TYPE_CHECKING:
    from groundstation.ros.types import RosTypes

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
ARM = "~/arm"
SERVED = {ARM: "std_srvs/srv/SetBool", **PARAMETER_SERVICES}
"""Service -> its type."""
DIAGNOSTICS_PERIOD = 1.0
"""s"""

NOTE, LEFT, TWIST, WORD, CALL = "note", "left", "twist", "word", "call"
"""What the companion sends: each with the time, and a text; a topic and a publisher; these and the demand; or number,
name and request of a call of a service."""
PUBLISH, REPLY = "publish", "reply"
"""What the verb sends: topic and values, or the number of a call and its response."""


def domain(text: str) -> int:
    """Parse a ROS domain. Raises ArgumentTypeError."""
    if not (text.isascii() and text.isdecimal() and int(text) <= LAST_DOMAIN):
        raise argparse.ArgumentTypeError(f"{text!r} is not a domain from 0 to {LAST_DOMAIN}")
    return int(text)


def prepare(options: argparse.Namespace) -> None:
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
    node = _NodeUser(session, driver, options)
    if options.arm:
        armed, text = await driver.set_armed(True, options.wait)
        if not armed:
            raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name}: {text}")
    await driver.run_beside(node.listen(), node.publish())
    return ExitCode.DONE


class _NodeUser:
    """The verb's half: what the node of the companion has received, and is to publish."""

    def __init__(self, session: VerbSession, driver: RosDriver, options: argparse.Namespace) -> None:
        self._session, self._driver, self._options = session, driver, options
        self._name = options.node or f"mavhelm_{session.vehicle.system}"
        self._services = {ARM: self._arm, **parameter_services(session)}
        self._calls: set[asyncio.Task[None]] = set()

    async def listen(self) -> None:
        """Begin the node, and handle what it receives, until cancelled. Raises VerbError."""
        companion = self._session.companion
        companion.send(self._name)
        try:
            while True:
                self._handle(*await companion.receive())
        finally:
            for call in self._calls:
                call.cancel()

    def _handle(self, what: str, at: float, *values: Any) -> None:
        if what == NOTE:
            self._driver.note(*values)
        elif what == LEFT:
            self._driver.remove(values)
        elif what == CALL:
            task = asyncio.ensure_future(self._serve(*values))
            self._calls.add(task)
            task.add_done_callback(self._calls.discard)
        elif self._session.now - at <= MAX_LATENESS:
            topic, publisher, *demand = values
            push = self._driver.push_word if what == WORD else self._driver.push_twist
            push((topic, publisher), *demand)

    async def _serve(self, number: int, service: str, request: Values) -> None:
        self._session.companion.send((REPLY, number, await self._services[service](request)))

    async def _arm(self, request: Values) -> Values:
        done, text = await self._driver.set_armed(bool(request["data"]), self._options.wait)
        return {"success": done, "message": text}

    async def publish(self) -> None:
        """Publish what the vehicle reports, and its diagnostics, until cancelled."""
        self._session.core.taps.append(self._take_text)
        publish_telemetry(self._session, self._publish)
        await request_rates(self._session, self._options.rate)
        while True:
            view = self._session.vehicle.build_view(self._session.now)
            self._send("/diagnostics", diagnostics(view, self._driver.engaged, unix_time()))
            await asyncio.sleep(DIAGNOSTICS_PERIOD)

    def _take_text(self, received: Received, now: float) -> None:
        text, state = received.message, self._session.vehicle
        if isinstance(text, m.StatusText) and (received.system, received.component) == (state.system, state.component):
            self._send("/rosout", log_line(text.text, text.severity, self._name, unix_time()))

    def _publish(self, topic: str, kind: str, values: Values) -> None:
        self._send(topic, values)
        if self._options.tf and kind == ODOMETRY:
            self._send(TRANSFORMS, transforms(values))

    def _send(self, topic: str, values: Values) -> None:
        self._session.companion.send((PUBLISH, topic, values))


async def serve(options: argparse.Namespace, output: Output, verb: CompanionChannel) -> None:
    """Be the node, as the companion of the verb: in the environment of the user, with the libraries of ROS."""
    node = _Node(options, await verb.receive(), verb)
    node.start()
    try:
        while True:
            node.handle(*await verb.receive())
    finally:
        node.close()


class _Node:
    """The companion's half: the node with its topics and services."""

    def __init__(self, options: argparse.Namespace, name: str, verb: CompanionChannel) -> None:
        from groundstation.ros2.node import NodeNames, Ros2Node

        self._verb = verb
        self._numbers = count(1)
        self._calls: dict[int, asyncio.Future[Values]] = {}
        names = NodeNames(options.router, options.domain, options.namespace, name)
        self._node = Ros2Node(
            names,
            lambda text: self._tell(NOTE, text),
            lambda topic, gid: self._tell(LEFT, topic.rpartition("/")[2], gid),
            options.types,
        )
        for topic, kind in PUBLISHED.items():
            self._node.add_publisher(topic, kind)
        if options.tf:
            self._node.add_publisher(TRANSFORMS, TRANSFORM_TYPE)
        self._node.add_subscription(CMD_VEL, TWIST_TYPE, self._take_twist)
        self._node.add_subscription(CMD_VEL, STAMPED_TYPE, lambda gid, stamped: self._take_twist(gid, stamped.twist))
        self._node.add_subscription(COMMAND, WORD_TYPE, lambda gid, word: self._tell(WORD, COMMAND, gid, word.data))
        for service, kind in SERVED.items():
            if service != ARM or options.arm_service:
                self._node.add_service(service, kind, partial(self._call, service))
        self.start, self.close = self._node.start, self._node.close

    def handle(self, what: str, *values: Any) -> None:
        """Handle what the verb sends."""
        if what == PUBLISH:
            self._node.publish(*values)
        elif what == REPLY:
            number, reply = values
            self._calls.pop(number).set_result(reply)

    def _take_twist(self, gid: bytes, twist: Any) -> None:
        linear = (twist.linear.x, twist.linear.y, twist.linear.z)
        self._tell(TWIST, CMD_VEL, gid, linear, twist.angular.z)

    async def _call(self, service: str, request: Any) -> Values:
        number, reply = next(self._numbers), asyncio.get_running_loop().create_future()
        self._calls[number] = reply
        self._tell(CALL, number, service, self._node.types.to_plain(request))
        values: Values = await reply
        return values

    def _tell(self, what: str, *values: Any) -> None:
        self._verb.send((what, asyncio.get_running_loop().time(), *values))
