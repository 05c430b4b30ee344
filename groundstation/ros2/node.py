"""Ros2Node: a node that other nodes see, with topics and services by name. All of it runs in the event loop."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import Any

import msgspec

from groundstation.ros.freshness import MAX_LATENESS, LatenessCheck
from groundstation.ros.rmw.attachment import Attachment, gid_of
from groundstation.ros.rmw.names import BEST_EFFORT_5, RELIABLE_10, EntityKind, RmwEndpoint, RmwNode
from groundstation.ros.types import BadMessageError, RosTypes
from groundstation.ros.vehicle import Values
from groundstation.ros2.router import RosRouter
from groundstation.ros2.wire import Arrived, Request, RosWire, WireEvents

MAX_CALLS = 32
"""Requests that are served at once; further ones get no answer, and their clients time out."""

Take = Callable[[bytes, Any], None]
"""Takes the id of a publisher and its message."""
Serve = Callable[[Any], Awaitable[Values]]
"""Takes a request, returns the values of the response."""


class NodeNames(msgspec.Struct, frozen=True):
    """How the node is called, and where it lives."""

    router: RosRouter
    domain: int
    namespace: str
    name: str


class _Plan(msgspec.Struct):
    """An endpoint before the session is open."""

    kind: EntityKind
    name: str
    type: str
    qos: str


class _Topic(msgspec.Struct):
    """A topic that is published."""

    endpoint: RmwEndpoint
    gid: bytes
    count: int = 0


class Ros2Node(msgspec.Struct):
    """Add topics and services, then start(); close() at the end."""

    names: NodeNames
    note: Callable[[str], None]
    """Takes a line for the user."""
    left: Callable[[str, bytes], None]
    """A publisher of a topic, by its name and id, has left."""
    types: RosTypes
    """With all types and services that it will have, prepared."""
    ready: bool = False
    """The node is seen by others."""
    _plans: list[_Plan] = msgspec.field(default_factory=list)
    _topics: dict[str, _Topic] = msgspec.field(default_factory=dict)
    _takes: dict[int, Take] = msgspec.field(default_factory=dict)
    """Number of an endpoint -> what takes its messages; one topic may have several types."""
    _serves: dict[int, Serve] = msgspec.field(default_factory=dict)
    _calls: set[asyncio.Task[None]] = msgspec.field(default_factory=set)
    _lateness: LatenessCheck = msgspec.field(default_factory=LatenessCheck)
    _wire: RosWire | None = None
    _told: str = ""

    # ---- what it has ----

    def add_publisher(self, topic: str, kind: str) -> None:
        """Publish a topic; `publish` sends its messages."""
        self._plans.append(_Plan(EntityKind.PUBLISHER, topic, kind, RELIABLE_10))

    def add_subscription(self, topic: str, kind: str, take: Take) -> None:
        """Handle the messages of a topic."""
        self._plans.append(_Plan(EntityKind.SUBSCRIPTION, topic, kind, BEST_EFFORT_5))
        self._takes[len(self._plans)] = take

    def add_service(self, name: str, kind: str, serve: Serve) -> None:
        """Serve requests."""
        self._plans.append(_Plan(EntityKind.SERVICE, name, kind, RELIABLE_10))
        self._serves[len(self._plans)] = serve

    def start(self) -> None:
        """Connect to the router, and try again until it is there."""
        events = WireEvents(self._opened, self._tell, self._take, self.left, self._request)
        self._wire = RosWire(self.names.router, events)
        self._wire.start()

    def close(self) -> None:
        """Leave the graph."""
        for task in self._calls:
            task.cancel()
        if self._wire is not None:
            self._wire.close()

    def publish(self, topic: str, values: Values) -> None:
        """Send a message now, or not at all without a router."""
        entry = self._topics.get(topic)
        if entry is None or self._wire is None:
            return
        entry.count += 1
        data = self.types.encode(entry.endpoint.type, values)
        self._wire.publish(entry.endpoint.key, data, Attachment(entry.count, time.time_ns(), entry.gid))

    # ---- events ----

    def _opened(self, session: str) -> None:
        node = RmwNode(self.names.domain, session, self.names.namespace, self.names.name)
        endpoints = []
        for number, plan in enumerate(self._plans, 1):
            whole = node.resolve(plan.name)
            endpoint = RmwEndpoint(node, number, plan.kind, whole, plan.type, self.types.hash(plan.type), plan.qos)
            endpoints.append(endpoint)
            if plan.kind is EntityKind.PUBLISHER:
                self._topics[plan.name] = _Topic(endpoint, gid_of(endpoint.token))
        assert self._wire is not None
        self._wire.declare(node.domain, [node.token, *(each.token for each in endpoints)], endpoints)
        self.ready, self._told = True, ""
        self.note(f"node {node.resolve(node.name)} at {self.names.router.locator}, domain {node.domain}")

    def _tell(self, problem: str) -> None:
        if problem != self._told:
            self._told = problem
            self.note(f"{problem}; trying again")

    def _take(self, arrived: Arrived) -> None:
        now = asyncio.get_running_loop().time()  # a message that this program was late to take is late, too
        late = self._lateness.lateness(arrived.attachment.gid, arrived.attachment.stamp, now)
        if late > MAX_LATENESS:
            self.note(f"{arrived.endpoint.name}: messages come more than {MAX_LATENESS:g} s late; ignored")
            return
        try:
            message = self.types.decode(arrived.endpoint.type, arrived.data)
        except BadMessageError as error:
            self.note(f"{arrived.endpoint.name}: {error}; ignored")
            return
        self._takes[arrived.endpoint.number](arrived.attachment.gid, message)

    def _request(self, request: Request) -> None:
        if len(self._calls) < MAX_CALLS:
            task = asyncio.get_running_loop().create_task(self._serve(request))
            self._calls.add(task)
            task.add_done_callback(self._calls.discard)

    async def _serve(self, request: Request) -> None:
        kind = request.endpoint.type
        try:
            message = self.types.decode(f"{kind}_Request", request.data)
        except BadMessageError as error:
            self.note(f"{request.endpoint.name}: {error}; ignored")
            return
        values = await self._serves[request.endpoint.number](message)
        request.reply(self.types.encode(f"{kind}_Response", values))
