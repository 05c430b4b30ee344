"""Key expressions of topics and services, and the liveliness tokens that make the graph of `ros2 node list`.

<domain>/<name without its first slash>/<type>/<hash>
@ros2_lv/<domain>/<session>/<node>/<entity>/<kind>/<enclave>/<namespace>/<node name>[/<name>/<type>/<hash>/<QoS>]

In a token each slash of a name is a percent sign. https://github.com/ros2/rmw_zenoh/blob/rolling/docs/design.md
"""

from __future__ import annotations

import re
from enum import StrEnum

import msgspec

ADMIN_SPACE = "@ros2_lv"
RELIABLE_10, BEST_EFFORT_5 = "::,10:,:,:,,", "2::,5:,:,:,,"
"""Quality of service as rmw_zenoh_cpp writes it: what differs from its defaults (reliable, volatile, keep last 42)."""
_PARTS = 13
"""Parts of a token that is not that of a node."""
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class EntityKind(StrEnum):
    """What a token stands for."""

    NODE = "NN"
    PUBLISHER = "MP"
    SUBSCRIPTION = "MS"
    SERVICE = "SS"
    CLIENT = "SC"


class RmwNode(msgspec.Struct, frozen=True):
    """A node of one session. `namespace` begins with a slash, as in ROS."""

    domain: int
    session: str
    """Zenoh's id of the session."""
    namespace: str
    name: str

    @property
    def token(self) -> str:
        """Its liveliness token."""
        return self._token(0, EntityKind.NODE)

    def resolve(self, name: str) -> str:
        """Return the whole name of a topic or service: "~" is the node, without a first slash it is relative."""
        base = self.namespace.rstrip("/")
        if name.startswith("~"):
            return f"{base}/{self.name}{name[1:]}"
        return name if name.startswith("/") else f"{base}/{name}"

    def _token(self, entity: int, kind: EntityKind) -> str:
        names = f"%/{mangle(self.namespace)}/{self.name}"
        return f"{ADMIN_SPACE}/{self.domain}/{self.session}/0/{entity}/{kind}/{names}"


class RmwEndpoint(msgspec.Struct, frozen=True):
    """A publisher, subscription, service or client of a node. `number` is > 0 and its own in the session."""

    node: RmwNode
    number: int
    kind: EntityKind
    name: str
    """Whole name."""
    type: str
    """As in "geometry_msgs/msg/Twist"."""
    hash: str
    qos: str = RELIABLE_10

    @property
    def key(self) -> str:
        """The key under which its messages or requests go."""
        return f"{self.node.domain}/{self.name.strip('/')}/{dds_type(self.type)}/{self.hash}"

    @property
    def token(self) -> str:
        """Its liveliness token."""
        head = self.node._token(self.number, self.kind)
        return f"{head}/{mangle(self.name)}/{dds_type(self.type)}/{self.hash}/{self.qos}"


def publisher_tokens(domain: int, name: str) -> str:
    """Return the key expression of the tokens of all publishers of a topic."""
    return f"{ADMIN_SPACE}/{domain}/*/*/*/{EntityKind.PUBLISHER}/*/*/*/{mangle(name)}/*/*/*"


def mangle(name: str) -> str:
    """Return a name as one part of a key: with % for slashes."""
    return name.replace("/", "%")


def dds_type(kind: str) -> str:
    """Return the type as DDS names it: "geometry_msgs::msg::dds_::Twist_"."""
    package, group, name = kind.split("/")
    return f"{package}::{group}::dds_::{name}_"


def name_fault(name: str) -> str | None:
    """Return why text is not a name of a node or part of a namespace, or None."""
    return None if _NAME.fullmatch(name) else f"{name!r} is not letters, digits and _, with a letter first"


def namespace_fault(namespace: str) -> str | None:
    """Return why text is not a namespace, or None. "/" is the one of everybody."""
    if not namespace.startswith("/"):
        return f"{namespace!r} does not begin with /"
    return next((fault for part in namespace.split("/")[1:] if part and (fault := name_fault(part))), None)
