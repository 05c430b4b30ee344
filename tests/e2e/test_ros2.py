"""`mavhelm ros2` with a router, a simulated rover and another node as processes: all ends are stops."""

from __future__ import annotations

import signal
import struct
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest

from groundstation.ros.freshness import MAX_LATENESS
from groundstation.ros.parameters import value_of
from groundstation.ros.services import SERVICES
from groundstation.ros.sources import TWIST_SILENCE
from groundstation.ros.types import RosTypes
from link.services.param.client import Param
from tests.e2e import ros2_peer
from tests.e2e.ros2_peer import CDR, TWIST, Peer
from tests.e2e.ros2_world import ARM, SET_BOOL, World, kill
from tests.waits import PATIENCE, Waits

pytestmark = [pytest.mark.e2e, pytest.mark.slow]
TRIES = 6
"""Times that a stream goes on without a gap, of which a late machine may spoil some."""
PARAMETERS = "0/mavhelm_1/{}_parameters/rcl_interfaces::srv::dds_::{}Parameters_/RIHS01_{}"
GET = PARAMETERS.format("get", "Get", "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc")
SET = PARAMETERS.format("set", "Set", "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0")


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    with ExitStack() as stack:
        yield World(tmp_path, stack)


def _keep(heard: dict[str, bytes], topic: str, data: bytes, attachment: bytes) -> None:
    heard[topic] = data


def _send_nonsense(peer: Peer) -> None:
    """Send what is not a demand: NaN, other bytes, an unknown word, and a Twist without an attachment."""
    peer.twist(float("nan"), 1.0)
    peer.put("cmd_vel", TWIST, b"\xff" * 9)
    peer.word("faster")
    peer.session.put(f"0/cmd_vel/{TWIST}", CDR + struct.pack("<6d", 1, 0, 0, 0, 0, 0))


def test_messages_drive_and_every_end_is_a_stop(world: World) -> None:
    node = world.start("--arm", "--arm-service")
    peer = world.peer
    with world.repeating(lambda: peer.twist(1.0)):
        world.turns()
    world.stands()  # silence
    with world.repeating(lambda: peer.word("i")):
        world.turns(lambda: peer.word("k"))
    world.stands()
    with world.repeating(lambda: peer.stamped(1.0)):
        world.turns(lambda: peer.stamped(0.0))
    world.stands()
    with world.repeating(partial(_send_nonsense, peer)):
        world.until(lambda: "refused: linear.x nan" in world.text, "NaN is not refused")
        world.until(lambda: "are not a geometry_msgs/msg/Twist" in world.text, "garbage is not refused")
        assert world.vehicle.stands()
    others: list[subprocess.Popen[bytes]] = []

    def begin_another() -> None:
        for each in others:
            kill(each)
        others[:] = [ros2_peer.start("publish", world.router, 1.0, 0.0)]
        world.stack.callback(kill, others[0])

    begin_another()
    world.turns(begin_another)
    others[0].kill()
    world.stands()
    with world.repeating(lambda: peer.twist(1.0)):
        world.turns()
        world.router_process.kill()
        world.stands()
        world.start_router()
        world.turns()
    world.stands()
    with world.repeating(lambda: peer.twist(0.5, 1.0)):
        world.turns()
        node.send_signal(signal.SIGKILL)
        world.stands()
        assert node.wait(PATIENCE) == -signal.SIGKILL


def test_a_router_that_stood_still_delivers_no_old_command(world: World) -> None:
    world.start("--arm", "--arm-service")
    peer = world.peer
    with world.repeating(lambda: peer.twist(1.0)):
        world.turns()
        world.router_process.send_signal(signal.SIGSTOP)
        world.stands()
    ended = time.monotonic()
    world.until(lambda: time.monotonic() > ended + 3 * MAX_LATENESS, "")  # also the newest message is old now
    thawed = time.monotonic()
    world.router_process.send_signal(signal.SIGCONT)
    world.until(lambda: "messages come more than" in world.text, "what was held up was not delivered, or not noticed")
    with world.repeating(lambda: peer.twist(0.0)):
        world.until(lambda: peer.tokens() != [], "the router does not answer")
    assert not world.vehicle.moved_since(thawed)
    with world.repeating(lambda: peer.twist(1.0)):
        world.turns()
    world.stands()


def test_graph_telemetry_parameters_and_arming_through_a_station(world: World) -> None:
    node = world.start("--tf", "--arm-service", *world.start_station())
    peer = world.peer
    tokens: list[str] = []

    def node_is_known() -> bool:
        tokens[:] = peer.tokens()
        return any(each.endswith("/0/0/NN/%/%/mavhelm_1") for each in tokens)

    world.until(node_is_known, "the node has no token")
    kinds = {"/".join(each.split("/")[5:6] + each.split("/")[9:10]) for each in tokens}
    assert {"MP/%odom", "MP/%tf", "MS/%cmd_vel", "SS/%mavhelm_1%arm", "SS/%mavhelm_1%set_parameters"} <= kinds
    heard: dict[str, bytes] = {}
    for topic in ("odom", "imu", "fix", "battery_state", "diagnostics", "tf"):
        peer.listen(f"0/{topic}/**", partial(_keep, heard, topic))
    with world.repeating(lambda: peer.twist(1.0)):
        world.until(lambda: "is disarmed" in world.text, "a message moves a disarmed vehicle, or nobody is told")
        assert not any(each.turning for each in world.vehicle.outputs())
        _arm_below_a_stream(world, node)
    peer.twist(0.0)
    with world.repeating(lambda: peer.twist(0.0, 2.0)):
        world.turns()
    assert world.call(ARM, SET_BOOL, b"\x00").success
    world.stands()
    name = b"\x01\x00\x00\x00\x0b\x00\x00\x00FS_TIMEOUT\x00"
    get = "rcl_interfaces/srv/GetParameters"
    before = world.call(GET, get, name).values[0]
    assert (before.type, before.double_value > 0) == (3, True)
    types = RosTypes()
    kind = "rcl_interfaces/srv/SetParameters"
    types.register_service(kind, *SERVICES[kind])
    wanted = {"name": "FS_TIMEOUT", "value": value_of(Param("FS_TIMEOUT", 2.5, 9, None))}
    request = types.encode(f"{kind}_Request", {"parameters": [wanted, wanted | {"name": "NO_SUCH"}]})
    results = world.call(SET, kind, request.removeprefix(CDR)).results
    assert [each.successful for each in results] == [True, False]
    assert "no such parameter" in results[1].reason
    assert world.call(GET, get, name).values[0].double_value == 2.5
    wanted_topics = {"odom", "imu", "fix", "battery_state", "diagnostics", "tf"}
    world.until(lambda: heard.keys() == wanted_topics, f"not published: {wanted_topics - heard.keys()}")
    odometry = types.decode("nav_msgs/msg/Odometry", heard["odom"])
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    status = types.decode("diagnostic_msgs/msg/DiagnosticArray", heard["diagnostics"]).status[0]
    assert status.hardware_id == "1"
    assert world.call(ARM, SET_BOOL, b"\x01").success
    with world.repeating(lambda: peer.twist(1.0)):
        world.turns()
        node.send_signal(signal.SIGINT)
        world.stands()
        assert node.wait(PATIENCE) == 128 + signal.SIGINT
    world.until(lambda: _is_disarmed(world.vehicle.errors.read_text()), "it stays armed")


def _arm_below_a_stream(world: World, node: subprocess.Popen[bytes]) -> None:
    """Arm while a stream goes on, which must show zero, or fall silent as on a late machine, before it drives."""
    for _ in range(TRIES):
        waits, began = Waits(node.pid, world.router_process.pid), time.monotonic()
        armed = world.call(ARM, SET_BOOL, b"\x01")
        assert (armed.success, armed.message) == (True, "Rover 1 is armed")
        later = world.peer.count + 20
        world.until(partial(_has_published, world.peer, later), "nothing is published")
        if not world.vehicle.moved_since(began):
            return
        assert waits.total() > TWIST_SILENCE, "the stream drives at once"
        assert world.call(ARM, SET_BOOL, b"\x00").success
        world.stands()
    raise AssertionError(f"the stream was late {TRIES} times")


def _has_published(peer: Peer, count: int) -> bool:
    return peer.count >= count


def test_a_kill_while_a_station_sends_its_demands(world: World) -> None:
    node = world.start("--arm", "--arm-service", *world.start_station())
    with world.repeating(lambda: world.peer.twist(1.0)):
        world.turns()
        node.kill()
        world.stands()


def _is_disarmed(told: str) -> bool:
    return told.rindex("Disarmed") > told.rindex("Armed by")
