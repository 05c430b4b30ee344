"""--dialect with a peer that pymavlink generates from a user's file: the station process shows its fields by name."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import pytest

from dialects.extra.dialect import SHIPPED
from groundstation.client import StationClient, StationError
from groundstation.intents.watch import Watch
from groundstation.views.messages import MessageField, MessageRequest, MessagesPage, MessagesRequest, MessageView
from tests.dialects.extra.peers import generate
from tests.dialects.extra.xml_texts import GRIPPER, with_message
from tests.groundstation.screen import Screen
from tests.ports import free_port

STATUS = MessageRequest(1, 1, False, "GRIPPER_STATUS")


def peer_module(folder: Path) -> Any:
    """Return what a user's vehicle is built with: mavgen looks for includes beside the file only."""
    (folder / "minimal.xml").write_bytes((SHIPPED / "minimal.xml").read_bytes())
    (folder / "gripper.xml").write_text(GRIPPER)
    return generate(folder / "gripper.xml", folder / "gripper.py")


@contextmanager
def sending(module: Any, endpoint: str) -> Iterator[None]:
    """Send a HEARTBEAT, the status of the gripper and a message of a third dialect, 20 times a second."""
    host, port = endpoint.removeprefix("udpin:").split(":")
    peer = module.MAVLink(None, srcSystem=1, srcComponent=1)
    unknown = bytes([0xFD, 2, 0, 0, 9, 1, 1, 0x60, 0xEA, 0, 1, 2, 0x12, 0x34])
    ended = threading.Event()

    def run() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            while not ended.wait(0.05):
                beat = peer.heartbeat_encode(10, 0, 0, 0, 4)
                status = peer.gripper_status_encode(1, 12100, 3, b"left", [1.5, -2.0, 0.25], 77_000)
                for message in (beat, status):
                    sock.sendto(message.pack(peer), (host, int(port)))
                    peer.seq = (peer.seq + 1) & 0xFF
                sock.sendto(unknown, (host, int(port)))

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def watch(screen: Screen) -> tuple[MessagesPage, MessageView]:
    """Return the rows and the newest status, once both and an unknown id are there."""
    page: MessagesPage | None = None
    detail: MessageView | None = None
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        screen.see(lambda seen: True)
        for view in screen.client.pop_views():
            page = view if isinstance(view, MessagesPage) else page
            detail = view if isinstance(view, MessageView) else detail
        if page is not None and detail is not None and any(row.unknown for row in page.rows):
            return page, detail
    raise AssertionError(f"not seen: {page}, {detail}")


@pytest.mark.e2e
def test_a_message_of_the_users_dialect_is_shown_with_its_fields(tmp_path: Path) -> None:
    module = peer_module(tmp_path)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "mine.xml").write_text(GRIPPER)  # minimal.xml is pymavlink's there
    with Screen(dialect=str(tmp_path / "other" / "mine.xml")) as screen, sending(module, screen.endpoint):
        screen.client.send(Watch((MessagesRequest(), STATUS)))
        page, detail = watch(screen)
        seen = screen.see(lambda seen: bool(seen.links))
    assert [row.name for row in page.rows if row.system == 1] == ["", "GRIPPER_STATUS", "HEARTBEAT", "#60000"]
    assert detail.id == 51000
    assert all(field.spark for field in detail.fields if field.name in ("mode", "supply", "time_boot_ms"))
    assert tuple(msgspec.structs.replace(field, spark="") for field in detail.fields) == (
        MessageField("mode", "1", "", "SHUT"),
        MessageField("supply", "12100", "mV", "12.100 V"),
        MessageField("flags", "0x3", "", "2 flags", ("HOT", "HOLDS")),
        MessageField("label", "left", ""),
        MessageField("force", "1.5 -2 0.25", ""),
        MessageField("time_boot_ms", "77000", "ms", "77.000 s"),
    )
    assert (seen.links[0].crc_errors, seen.links[0].problem) == (0, None)
    assert any("3 messages, 2 of them added: GRIPPER_STATUS" in line.text for line in seen.texts)


@pytest.mark.e2e
def test_a_file_with_a_mistake_ends_the_start_with_one_line(tmp_path: Path) -> None:
    file = tmp_path / "mine.xml"
    file.write_text(with_message('<field type="uint8" name="a"/>'))
    with pytest.raises(StationError) as caught:
        StationClient.start([f"udpin:127.0.0.1:{free_port()}"], dialect=str(file))
    assert str(caught.value) == f"{file}:3: field a: unknown type 'uint8': did you mean uint8_t?"
