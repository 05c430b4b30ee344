"""`groundstation ros1`: a vehicle as a node of ROS 1, which /command and /cmd_vel drive, and which publishes telemetry.

The node is a process of the system's Python (groundstation/ros1/). Whatever ends - a publisher, the node, the master,
this program - leaves the vehicle neutral: RosDriver has the rules.
"""

from __future__ import annotations

import argparse
import asyncio
import time
from typing import Any

from groundstation.ros.vehicle import RosVehicle
from groundstation.ros1.process import NodeEndedError, NodeProcess, running_node
from groundstation.verbs.common.arguments import Argument, seconds
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.ros.ros_driver import RosDriver
from groundstation.verbs.ros.ros_rates import RATE, request_rates
from groundstation.verbs.ros.ros_scale import ARGUMENTS as SCALE_ARGUMENTS
from groundstation.verbs.ros.ros_scale import learn_scale
from groundstation.verbs.session.session import VerbSession
from link.core import Received

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
    work = driver.run(), ros1.run(), ros1.arm(), request_rates(session, options.rate)
    tasks = [asyncio.ensure_future(each) for each in work]
    try:
        async with asyncio.timeout(options.seconds):
            await asyncio.gather(*tasks)  # the first error ends it
    except TimeoutError:
        pass  # --for is over
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.wait(tasks)
        await driver.leave()
    return ExitCode.DONE


class Ros1:
    """One node after another: a node ends when its master does."""

    def __init__(self, session: VerbSession, driver: RosDriver, options: argparse.Namespace, output: Output) -> None:
        self._session, self._driver, self._output = session, driver, output
        self._options = options
        self._senders: set[tuple[str, str]] = set()
        self._ready = asyncio.Event()

    async def run(self) -> None:
        """Run nodes until cancelled. Raises VerbError."""
        while True:
            await self._run_node()
            await asyncio.sleep(REJOIN_AFTER)

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

    async def _run_node(self) -> None:
        """Run a node; return when its master has ended. Raises VerbError."""
        python, name = self._options.python, f"mavhelm_{self._session.vehicle.system}"
        try:
            async with running_node(python, name, TOPICS) as node:
                telemetry = Ros1Telemetry(self._session, node)
                self._session.core.taps.append(telemetry.take)
                try:
                    while await self._handle(await node.read(), telemetry):
                        pass
                finally:
                    self._session.core.taps.remove(telemetry.take)
        except OSError as error:
            raise VerbError(ExitCode.USAGE, f"--python {python}: {error.strerror}") from None
        except NodeEndedError as error:
            raise VerbError(ExitCode.BROKEN, f"{error}; neutral") from None
        finally:
            self._forget()

    async def _handle(self, line: dict[str, Any], telemetry: Ros1Telemetry) -> bool:
        """Handle a line of the node; return whether it goes on. Raises VerbError."""
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
                telemetry.ready = True
                self._ready.set()
                note(f"{self._session.vehicle.name} is {name} at {uri}: publish to command or cmd_vel")
            case {"silent": bool(silent), "master": str(uri)}:
                note(f"the ROS master at {uri} {SILENT if silent else 'answers again'}")
            case {"lost": str(text)}:
                note(f"the node has left ROS: {text}; neutral")
                return False
        return True

    def _take(self, topic: str, sender: str, at: float, values: dict[str, Any]) -> None:
        if self._session.now - at > LATE:
            return
        key = topic, sender
        self._senders.add(key)
        if topic == "command":
            self._driver.push_word(key, values["data"])
        else:
            self._driver.push_twist(key, values["linear"]["x"], values["angular"]["z"])

    def _forget(self, topic: str | None = None) -> None:
        """Forget the publishers of a topic, or all."""
        for key in [each for each in self._senders if topic in (None, each[0])]:
            self._senders.discard(key)
            self._driver.remove(key)


class Ros1Telemetry:
    """Telemetry of the vehicle, published by a node once it is ready."""

    def __init__(self, session: VerbSession, node: NodeProcess) -> None:
        self._system = session.vehicle.system
        self._vehicle = RosVehicle(session.vehicle.component)
        self._node = node
        self.ready = False

    def take(self, received: Received, now: float) -> None:
        """Publish what a message says."""
        if (received.system, received.component) != (self._system, self._vehicle.component):
            return
        made = self._vehicle.take(received.message, time.time_ns() // 1000)
        if made is not None and self.ready and made[0] in NODE_TOPICS:
            topic, kind, values = made
            self._node.publish(topic, kind.replace("/msg/", "/"), values)
