"""`mavhelm ros1`: a vehicle as a node of ROS 1, which /command and /cmd_vel drive, and which publishes telemetry.

The node is a process of the system's Python (groundstation/ros1/), which the companion of the verb starts in the
environment of the user. Whatever ends - a publisher, the node, the master, this program - leaves the vehicle neutral:
RosDriver has the rules.
"""

from __future__ import annotations

import argparse
import asyncio
from typing import Any

from groundstation.ros.vehicle import Values
from groundstation.ros1.process import NodeEndedError, NodeProcess, running_node
from groundstation.verbs.common.arguments import Argument, seconds
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.ros.ros_driver import RosDriver
from groundstation.verbs.ros.ros_rates import RATE, publish_telemetry, request_rates
from groundstation.verbs.ros.ros_scale import ARGUMENTS as SCALE_ARGUMENTS
from groundstation.verbs.ros.ros_scale import learn_scale
from groundstation.verbs.session.session import VerbSession

TOPICS = {"command": "std_msgs/String", "cmd_vel": "geometry_msgs/Twist"}
"""Relative, so that ROS_NAMESPACE stands before them."""
NODE_TOPICS = {"odom", "imu", "fix", "battery_state"}
"""What the node publishes, of what groundstation/ros/vehicle.py makes."""
REJOIN_AFTER = 0.5
"""s before a new node looks for the master."""
LATE = 0.25
"""s after its arrival at the node for which a message counts: what waited longer, because this program stood still, is
not what its publisher wants now."""
SILENT = "does not answer: publishers that are connected still drive, new ones are not heard"
INSTALL = (
    "apt install python3-rospy python3-geometry-msgs python3-sensor-msgs python3-nav-msgs (Debian), "
    "or source the setup.bash of ROS; --python names another interpreter"
)

ARGUMENTS: tuple[Argument, ...] = (
    *SCALE_ARGUMENTS,
    RATE,
    ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "end after this time"}),
    ("--python", {"metavar": "PROGRAM", "default": "/usr/bin/python3",
                  "help": "an interpreter that has rospy (default: /usr/bin/python3)"}),
)  # fmt: skip


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Be a node until a signal or --for; done when neutral was sent. Raises VerbError."""
    await session.need_only_vehicle(options.vehicle)
    driver = RosDriver(session, await learn_scale(session, options), output)
    ros1 = Ros1(session, driver, options, output)
    rates = request_rates(session, options.rate)
    await driver.run_beside(ros1.run(), ros1.arm(), rates, seconds=options.seconds)
    return ExitCode.DONE


class Ros1:
    """What the nodes of the companion say and publish."""

    def __init__(self, session: VerbSession, driver: RosDriver, options: argparse.Namespace, output: Output) -> None:
        self._session, self._driver, self._output = session, driver, output
        self._options = options
        self._joined = False
        """A node is at its master."""
        self._senders: set[tuple[str, str]] = set()
        self._ready = asyncio.Event()

    async def run(self) -> None:
        """Handle what the nodes say, until cancelled. Raises VerbError."""
        companion = self._session.companion
        companion.send(f"mavhelm_{self._session.vehicle.system}")
        publish_telemetry(self._session, self._publish)
        try:
            while True:
                self._handle(await companion.receive())
        finally:
            self._forget()

    async def arm(self) -> None:
        """With --arm, arm once the node is ready. Raises VerbError: nothing arms later, at a time that surprises."""
        if not self._options.arm:
            return
        wait = self._options.wait
        try:
            await asyncio.wait_for(self._ready.wait(), wait)
        except TimeoutError:
            raise VerbError(ExitCode.NO_ANSWER, f"not armed: no ROS master within {wait:g} s (--wait)") from None
        armed, text = await self._driver.set_armed(True, wait)
        if not armed:
            raise VerbError(ExitCode.REFUSED, text)

    def _handle(self, line: dict[str, Any]) -> None:
        """Handle a line of the node. Raises VerbError."""
        note = self._output.note
        match line:
            case {"topic": str(topic), "from": str(sender), "at": float(at), "values": dict(values)}:
                self._take(topic, sender, at, values)
            case {"topic": str(topic), "publishers": 0}:
                self._forget(topic)
            case {"missing": str(text)}:
                raise VerbError(ExitCode.USAGE, f"{self._options.python} has no rospy ({text}): {INSTALL}")
            case {"waiting": str(uri)}:
                note(f"no ROS master at {uri}: start `roscore`, or set ROS_MASTER_URI")
            case {"ready": str(name), "master": str(uri)}:
                self._joined = True
                self._ready.set()
                note(f"{self._session.vehicle.name} is {name} at {uri}: publish to command or cmd_vel")
            case {"silent": bool(silent), "master": str(uri)}:
                note(f"the ROS master at {uri} {SILENT if silent else 'answers again'}")
            case {"lost": str(text)}:
                self._joined = False
                self._forget()
                note(f"the node has left ROS: {text}; neutral")

    def _publish(self, topic: str, kind: str, values: Values) -> None:
        if self._joined and topic in NODE_TOPICS:
            self._session.companion.send((topic, kind.replace("/msg/", "/"), values))

    def _take(self, topic: str, sender: str, at: float, values: dict[str, Any]) -> None:
        if self._session.now - at > LATE:
            return
        key = topic, sender
        self._senders.add(key)
        if topic == "command":
            self._driver.push_word(key, values["data"])
        else:
            linear = values["linear"]
            self._driver.push_twist(key, (linear["x"], linear["y"], linear["z"]), values["angular"]["z"])

    def _forget(self, topic: str | None = None) -> None:
        """Forget the publishers of a topic, or all."""
        for key in [each for each in self._senders if topic in (None, each[0])]:
            self._senders.discard(key)
            self._driver.remove(key)


async def serve(options: argparse.Namespace, output: Output, verb: CompanionChannel) -> None:
    """Run one node after another, as the companion: a node ends when its master does. Raises VerbError."""
    name = await verb.receive()
    try:
        while True:
            async with running_node(options.python, name, TOPICS) as node:
                tasks = asyncio.ensure_future(_read(node, verb)), asyncio.ensure_future(_publish(node, verb))
                try:
                    ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
                    for each in ended:
                        each.result()
                finally:
                    for task in tasks:
                        task.cancel()
            await asyncio.sleep(REJOIN_AFTER)
    except OSError as error:
        raise VerbError(ExitCode.USAGE, f"--python {options.python}: {error.strerror}") from None
    except NodeEndedError as error:
        raise VerbError(ExitCode.BROKEN, f"{error}; neutral") from None


async def _read(node: NodeProcess, verb: CompanionChannel) -> None:
    """Pass on what the node says, until it has left its master."""
    line: dict[str, Any] = {}
    while "lost" not in line:
        line = await node.read()
        verb.send(line)


async def _publish(node: NodeProcess, verb: CompanionChannel) -> None:
    """Publish what the verb sends, until it ends."""
    while True:
        node.publish(*await verb.receive())
