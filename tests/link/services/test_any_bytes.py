"""No bytes that pass the framer make a service raise, and all that it says can be sent."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import codec
from dialects import messages as m
from dialects.enums import MissionType
from link.core import Outgoing, Received
from link.services.ftp.client import FtpClient
from link.services.log.server import LogServer
from link.services.mission.client import MissionClient
from link.services.pacing import BulkPacer
from link.services.param.client import ParamClient
from tests.examples import examples
from tests.link import ftp_rig, mission_rig, param_rig
from tests.link.services_world import PEER

IDS = sorted(
    each.id
    for each in (
        *(m.ParamRequestList, m.ParamRequestRead, m.ParamSet, m.ParamValue, m.ParamError),
        *(m.MissionRequestList, m.MissionRequestPartialList, m.MissionWritePartialList, m.MissionCount),
        *(m.MissionRequest, m.MissionRequestInt, m.MissionItem, m.MissionItemInt, m.MissionAck, m.MissionClearAll),
        *(m.MissionSetCurrent, m.FileTransferProtocol, m.LogRequestList, m.LogRequestData, m.LogErase),
        *(m.LogRequestEnd, m.LogData, m.LogEntry, m.Heartbeat, m.CommandLong),
    )
)
FRAMES = st.tuples(st.sampled_from(IDS), st.binary(max_size=255))


def log_server() -> LogServer:
    files = ftp_rig.FtpRig().tree.find(b"/logs")
    assert files is not None
    return LogServer(files.folder, system=1, component=1, pacer=BulkPacer())


SERVERS: list[Callable[[], Any]] = [
    lambda: param_rig.ParamRig().server,
    lambda: mission_rig.MissionRig().server,
    lambda: ftp_rig.FtpRig().server,
    log_server,
]


def addressed(number: int, payload: bytes, system: int, component: int) -> m.Message:
    """A message with any content, but for us: else nearly none would get far."""
    message: Any = codec.decode(number, payload)
    if hasattr(message, "target_system"):
        message.target_system, message.target_component = system, component
    return message  # type: ignore[no-any-return]


@pytest.mark.parametrize("make", SERVERS)
@settings(max_examples=examples(60))
@given(frames=st.lists(FRAMES, max_size=8))
def test_servers(make: Callable[[], Any], frames: list[tuple[int, bytes]]) -> None:
    server = make()
    for step, (number, payload) in enumerate(frames):
        message = addressed(number, payload, 1, 1)
        received = Received(message, 255, 190, step & 0xFF, PEER, introduced=True)
        sendable(server.receive(received, step * 0.3))
        sendable(server.tick(step * 0.3))


def begun(client: Any, begin: Callable[[Any], None]) -> Any:
    begin(client)
    return client


CLIENTS: list[Callable[[], Any]] = [
    lambda: begun(ParamClient(255, 190, target_system=1), lambda client: client.fetch(0.0)),
    lambda: begun(ParamClient(255, 190, target_system=1, bytewise=True), lambda client: client.set("A", 1e38, 0.0)),
    lambda: begun(MissionClient(255, 190, target_system=1), lambda each: each.download(MissionType.MISSION, 0.0)),
    lambda: begun(
        MissionClient(255, 190, target_system=1),
        lambda each: each.upload([mission_rig.waypoint()], MissionType.MISSION, 0.0),
    ),
    lambda: begun(FtpClient(255, 190, target_system=1), lambda client: client.download("/x", 0.0)),
    lambda: begun(FtpClient(255, 190, target_system=1), lambda client: client.list_folder("/", 0.0)),
]


@pytest.mark.parametrize("make", CLIENTS)
@settings(max_examples=examples(60))
@given(frames=st.lists(FRAMES, max_size=8))
def test_clients(make: Callable[[], Any], frames: list[tuple[int, bytes]]) -> None:
    client = make()
    for step, (number, payload) in enumerate(frames):
        message = addressed(number, payload, 255, 190)
        client.receive(Received(message, 1, 1, step & 0xFF, PEER, introduced=True), step * 0.3)
        client.tick(step * 0.3)
        client.outcomes()
        sendable(client.messages_to_send())


def sendable(outgoing: list[Outgoing]) -> None:
    for each in outgoing:
        codec.encode_payload(each.message)
