"""The node of ROS 1, as a script for the system's Python, which has rospy: `node.py NAME TOPIC=TYPE...`.

It imports nothing of this project, and works with Python 3.8, which ROS Noetic has on Ubuntu. Its stdin brings JSON
lines to publish, {"topic", "type", "values"}; a header is [microseconds, frame]. Its stdout gives JSON lines:

    {"missing": text}                    rospy cannot be imported; it ends
    {"waiting": uri}                     no master answers there
    {"ready": name, "master": uri}       it subscribes now
    {"topic", "from", "at", "values"}    a message, with the name of its publisher and time.monotonic()
    {"topic", "publishers": n}           how many publishers are connected, when that has changed
    {"silent": bool, "master": uri}      the master has not answered for SILENT_AFTER, or does again
    {"lost": text}                       the master has ended, or another node has its name; it ends

It ends with stdin. It also ends when its master does, because rospy does not register with the next one.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

LOOK_PERIOD = 0.05
"""s between two looks at the connections: how fast the end of a publisher's process is noticed."""
MASTER_PERIOD = 0.25
"""s between two questions to the master."""
SILENT_AFTER = 2.0
"""s without an answer after which the master counts as frozen: on a busy machine it takes 0.5 s."""
END_WITHIN = 0.5
"""s to sign off at the master."""
PUBLISHED = ("nav_msgs/Odometry", "sensor_msgs/Imu")
"""Types that its stdin may name, one of each package: what is missing is told at the start."""
BUFFER = 1 << 20
"""Bytes that are read at once: with a queue of 1 only the newest message of them counts."""


class Pipe:
    """The parent's end of stdout. rospy's own prints go to stderr."""

    def __init__(self) -> None:
        self._file = os.fdopen(os.dup(1), "w", encoding="utf-8")
        self._lock = threading.Lock()
        os.dup2(2, 1)

    def write(self, **fields: Any) -> None:
        """Write a line; end without a parent."""
        try:
            with self._lock:
                self._file.write(json.dumps(fields) + "\n")
                self._file.flush()
        except OSError:
            os._exit(0)


class Master:
    """The master, as its process: another one at the same address does not know this node."""

    def __init__(self, rosgraph: Any) -> None:
        self.uri = rosgraph.get_master_uri()
        self._master = rosgraph.Master("/mavhelm", self.uri)
        self._process: int | None = None

    def problem(self) -> str:
        """Return what is wrong with it, or ''."""
        try:
            process = self._master.getPid()
        except Exception as error:  # of sockets, HTTP, XML and rosgraph
            return f"{self.uri}: {error}"
        self._process = self._process or process
        return "" if process == self._process else f"{self.uri} was restarted"


class MasterWatch:
    """Asks the master again and again in a thread of its own: one that stands still never answers."""

    def __init__(self, master: Master) -> None:
        self._master = master
        self._asked: float | None = None
        self.problem: str | None = None
        """What is wrong with it, '' if nothing is; None before its first answer."""
        threading.Thread(target=self._ask, daemon=True).start()

    @property
    def silent(self) -> bool:
        """It does not answer."""
        asked = self._asked
        return asked is not None and time.monotonic() - asked > SILENT_AFTER

    def _ask(self) -> None:
        while True:
            self._asked = time.monotonic()
            self.problem = self._master.problem()
            self._asked = None
            time.sleep(MASTER_PERIOD)


def find_class(name: str) -> Any:
    """Return the class of a type, e.g. "std_msgs/String". Raises ImportError."""
    package, _, kind = name.partition("/")
    return getattr(importlib.import_module(package + ".msg"), kind)


def to_values(message: Any) -> Any:
    """Return a message as numbers, texts and dictionaries."""
    if isinstance(message, bytes):
        return message.decode(errors="replace")
    if hasattr(message, "__slots__"):
        return {name: to_values(getattr(message, name)) for name in message.__slots__}
    return message


def fill(message: Any, values: dict[str, Any], new_time: Callable[[int], Any]) -> None:
    """Set the fields of a message from a dictionary."""
    for name, value in values.items():
        if name == "header":
            message.header.stamp = new_time(value[0])
            message.header.frame_id = value[1]
        elif isinstance(value, dict):
            fill(getattr(message, name), value, new_time)
        else:
            setattr(message, name, value)


class Node:
    """Subscribes and publishes until the parent, the master or the node ends."""

    def __init__(self, rospy: Any, pipe: Pipe, master: Master) -> None:
        self._rospy, self._pipe = rospy, pipe
        self._uri, self.master = master.uri, MasterWatch(master)
        self._publishers: dict[str, tuple[Any, Any]] = {}
        self._subscribers: dict[str, Any] = {}

    def subscribe(self, topic: str, name: str) -> None:
        """Pass on what a topic brings; the newest message counts."""

        def take(message: Any) -> None:
            sender = message._connection_header.get("callerid", "?")
            fields = {"topic": topic, "from": sender, "at": time.monotonic(), "values": to_values(message)}
            self._pipe.write(**fields)

        kind = find_class(name)
        self._subscribers[topic] = self._rospy.Subscriber(
            topic, kind, take, queue_size=1, buff_size=BUFFER, tcp_nodelay=True
        )

    def publish(self) -> None:
        """Publish what stdin brings; its end is the end of the node."""
        for line in sys.stdin:
            row = json.loads(line)
            publisher, kind = self._find_publisher(row["topic"], row["type"])
            message = kind()
            fill(message, row["values"], self._new_time)
            with contextlib.suppress(self._rospy.ROSException):  # the node is being shut down
                publisher.publish(message)
        threading.Timer(END_WITHIN, os._exit, (0,)).start()  # if the master does not answer
        self._rospy.signal_shutdown("its program has ended")
        os._exit(0)

    def _find_publisher(self, topic: str, name: str) -> tuple[Any, Any]:
        if topic not in self._publishers:
            kind = find_class(name)
            self._publishers[topic] = self._rospy.Publisher(topic, kind, queue_size=1), kind
        return self._publishers[topic]

    def wait_for_master(self) -> None:
        """Wait until the master answers."""
        told = False
        while self.master.problem != "":
            if not told and (self.master.problem or self.master.silent):
                self._pipe.write(waiting=self._uri)
                told = True
            time.sleep(LOOK_PERIOD)

    def watch(self) -> str:
        """Look at the master and the connections; return why the node cannot go on."""
        silent = False
        counts: dict[str, int] = {}
        while not self._rospy.is_shutdown():
            if self.master.problem:
                return self.master.problem
            if self.master.silent != silent:
                silent = not silent
                self._pipe.write(silent=silent, master=self._uri)
            for topic, subscriber in self._subscribers.items():
                count = subscriber.get_num_connections()
                if counts.get(topic) != count:
                    counts[topic] = count
                    self._pipe.write(topic=topic, publishers=count)
            time.sleep(LOOK_PERIOD)
        return "another node took the name, or `rosnode kill` ended this one"

    def _new_time(self, microseconds: int) -> Any:
        return self._rospy.Time(microseconds // 1000000, microseconds % 1000000 * 1000)


def main() -> int:
    """Run the node; return the exit code."""
    del sys.path[0]  # the folder of this script
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which closes stdin
    pipe = Pipe()
    name, topics = sys.argv[1], [each.split("=") for each in sys.argv[2:]]
    try:
        import rosgraph
        import rospy

        for kind in [*PUBLISHED, *[kind for _, kind in topics]]:
            find_class(kind)
    except ImportError as error:
        pipe.write(missing=str(error))
        return 1
    master = Master(rosgraph)
    node = Node(rospy, pipe, master)
    threading.Thread(target=node.publish, daemon=True).start()
    node.wait_for_master()
    rospy.init_node(name, disable_signals=True)
    for topic, kind in topics:
        node.subscribe(topic, kind)
    pipe.write(ready=rospy.get_name(), master=master.uri)
    pipe.write(lost=node.watch())
    os._exit(1)  # threads of rospy may wait for the master


if __name__ == "__main__":
    sys.exit(main())
