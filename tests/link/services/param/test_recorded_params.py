"""The parameters of a real ArduRover 4.7, as recorded: its list and its param.pck, beside pymavlink's decoder."""

from __future__ import annotations

from functools import cache

import pytest
from pymavlink import mavftp

from dialects import messages as m
from link.core import Received
from link.protocol.channel import Channel
from link.services.ftp.protocol import FtpOpcode, parse_packet
from link.services.param.client import ParamClient
from link.services.param.float32 import same_float32
from link.services.param.unpack import unpack
from link.tlog.tlog import read_records
from tests.recorded import WHOLE_ARDUROVER, read_recording

pytestmark = pytest.mark.xdist_group("recorded parameters")
"""Each worker would play the recording."""

COUNT = 1297


@cache
def recorded() -> list[Received]:
    channel = Channel("recording", 0, system=254, component=190)
    records = read_records(read_recording(WHOLE_ARDUROVER))
    return [each for record in records for each in channel.receive(record.raw, "x", record.microseconds / 1e6)]


@cache
def listed() -> ParamClient:
    client = ParamClient(255, 190, target_system=1)
    client.fetch(0.0)
    for received in recorded():
        client.receive(received, 1.0)
    return client


def packed() -> bytes:
    """Return the file as its bursts brought it."""
    data = bytearray()
    for received in recorded():
        if isinstance(received.message, m.FileTransferProtocol):
            packet = parse_packet(received.message)
            if packet.op == FtpOpcode.ACK and packet.req_opcode == FtpOpcode.BURST:
                data.extend(bytes(max(0, packet.offset + len(packet.data) - len(data))))
                data[packet.offset : packet.offset + len(packet.data)] = packet.data
    return bytes(data)


def test_the_list_is_complete_although_its_count_changed() -> None:
    counts = {each.message.param_count for each in recorded() if isinstance(each.message, m.ParamValue)}
    assert len(counts) == 2
    assert listed().complete
    assert listed().total == COUNT


def test_the_file_is_what_pymavlink_reads_in_it() -> None:
    ours = unpack(packed())
    theirs = mavftp.MAVFTP.ftp_param_decode(packed())
    assert isinstance(ours, list)
    assert theirs is not None
    assert [param.name for param in ours] == [name.decode() for name, _, _ in theirs.params]
    assert all(same_float32(a.value, float(value)) for a, (_, value, _) in zip(ours, theirs.params, strict=True))


def test_the_file_and_the_list_agree_on_names_types_and_values() -> None:
    file = unpack(packed())
    assert isinstance(file, list)
    params = listed().params
    shared = [param for param in file if param.name in params]
    assert len(shared) > 0.95 * len(file)
    assert [param.name for param in shared if params[param.name].kind != param.kind] == []
    differing = [param.name for param in shared if not same_float32(params[param.name].value, param.value)]
    assert len(differing) < 20, "only what the vehicle itself changes"
