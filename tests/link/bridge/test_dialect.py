"""--dialect of the bridge: a message for one vehicle goes only where that vehicle is."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from dialects import codec
from dialects.extra.option import use_dialect
from link.bridge.__main__ import main
from link.routing.router import Router
from tests.dialects.extra.xml_texts import GRIPPER, scope
from tests.link.frames import heartbeat

STATION, VEHICLE, OTHER = (0, 1, 2)


def receivers(data: bytes) -> set[int]:
    """Return the links on which a bridge sends what arrives from the station; system 1 and 2 are on the others."""
    router = Router([(False, None)] * 3)
    for link, system in ((STATION, 255), (VEHICLE, 1), (OTHER, 2)):
        router.receive(link, [(heartbeat(0, system, 1), "peer")], 0.0)
    return {delivery.link for delivery in router.receive(STATION, [(data, "peer")], 0.1)}


def test_its_messages_are_routed_by_their_target(tmp_path: Path) -> None:
    file = tmp_path / "mine.xml"
    file.write_text(GRIPPER)
    with scope():
        use_dialect(str(file))
        command = codec.frame(51001, struct.pack("<HBB", 40, 1, 1), 1, 255, 1)
        assert receivers(command) == {VEHICLE}
        assert receivers(command[:-1] + bytes([command[-1] ^ 1])) == set()
    assert receivers(command) == {VEHICLE, OTHER}  # without it every frame of the id goes everywhere


def test_a_file_with_a_mistake_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["udpin:127.0.0.1:1", "udpin:127.0.0.1:2", "--dialect", "nowhere.xml"])
    assert caught.value.code == 2
    assert capsys.readouterr().err == "mavhelm bridge: nowhere.xml: no such file: name the XML file of the dialect\n"
