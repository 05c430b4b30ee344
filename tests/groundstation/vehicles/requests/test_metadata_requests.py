"""Texts that a vehicle serves: where they are, what can be wrong with them, and what is kept."""

from __future__ import annotations

import json
import zlib

import pytest

from dialects import messages as m
from groundstation.vehicles.requests.file_requests import FileRequests
from groundstation.vehicles.requests.metadata_requests import MetadataRequests
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.state.identity import METADATA, VERSION, VehicleIdentity
from link.services.ftp.client import FtpClient
from tests.link import ftp_rig
from tests.link.services_world import Pair, from_vehicle

GENERAL = {"metadataTypes": [{"type": 4, "uri": "mftp:///x"}, {"type": 1, "uri": "mftp://[;comp=1]/logs/p.json"}]}
PARAMETERS = {"parameters": [{"name": "A", "units": "s"}]}


def fetch(
    files: dict[str, object], uri: str = "mftp:///logs/g.json", cache: dict[int, bytes] | None = None
) -> MetadataRequests:
    """Let a vehicle say where its texts are, and follow that."""
    logs = {name: each if isinstance(each, bytes) else json.dumps(each).encode() for name, each in files.items()}
    vehicle, identity = ftp_rig.FtpRig(logs=logs, rate=1e6), VehicleIdentity(1)
    client = FtpClient(255, 190, target_system=1)
    requests = FileRequests(client, RequestBook())
    metadata = MetadataRequests(requests, identity, {} if cache is None else cache)
    pair = Pair(vehicle.server, client, requests)
    identity.receive(from_vehicle(m.AutopilotVersion(32, 0, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)))
    assert identity.next_request(0.0) is None, "not before they are wanted"
    metadata.want()
    assert identity.next_request(0.0) == METADATA
    identity.receive(from_vehicle(m.ComponentMetadata(0, zlib.crc32(uri.encode()), uri.encode())))
    metadata.tick(pair.now)
    pair.run_until(lambda: bool(metadata.docs.docs or metadata.problem), 20.0)
    return metadata


def test_texts_are_downloaded_and_kept() -> None:
    cache: dict[int, bytes] = {}
    found = fetch({"g.json": GENERAL, "p.json": PARAMETERS}, cache=cache)
    assert found.docs.get("A").unit == "s"
    assert (found.docs.source, found.problem) == ("the vehicle", "")
    again = fetch({}, cache=cache)
    assert again.docs.get("A").unit == "s", "without a file of the vehicle"


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({}, "texts of the vehicle: /logs/g.json: "),
        ({"g.json": b"{"}, "the vehicle's general metadata:1: this is not JSON"),
        ({"g.json": GENERAL}, "texts of the vehicle: /logs/p.json: "),
        ({"g.json": GENERAL, "p.json": b"[]"}, "the vehicle's parameter metadata: there is no list"),
    ],
)
def test_damaged_files_are_one_line(files: dict[str, object], words: str) -> None:
    found = fetch(files)
    assert found.docs.docs == {}
    assert found.problem.startswith(words)


def test_a_file_on_the_internet_is_not_fetched() -> None:
    found = fetch({}, "https://px4-travis.s3.amazonaws.com/general.json.xz")
    assert (
        found.problem
        == "texts of the vehicle: 'https://px4-travis.s3.amazonaws.com/general.json.xz' is not on the vehicle"
    )


def test_a_vehicle_without_files_is_not_asked() -> None:
    identity = VehicleIdentity(1)
    metadata = MetadataRequests(FileRequests(FtpClient(255, 190, target_system=1), RequestBook()), identity, {})
    metadata.want()
    assert identity.next_request(0.0) == VERSION
    identity.receive(from_vehicle(m.AutopilotVersion(0, 0, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)))
    metadata.want()
    assert identity.next_request(9.0) is None
