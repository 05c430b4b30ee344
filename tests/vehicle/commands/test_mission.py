"""A changed plan is reported to all ground stations: nobody need be in control to upload or clear one."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.ftp.protocol import FtpOpcode
from tests.vehicle.bench import DRIVER, OTHER, said
from tests.vehicle.commands.test_files import ask, fetch
from tests.vehicle.field import Field
from tests.vehicle.missions import Item, upload, way
from vehicle.navigation.geo import Point

CIRCLE: Item = (5003, Point(0.0, 0.0), (50.0,))
RALLY_POINT: Item = (5100, Point(1.0, 1.0), ())


@pytest.mark.parametrize(
    ("kind", "item", "text"),
    [
        (MissionType.MISSION, way(1.0, 0.0), "Mission changed, items: 1"),
        (MissionType.FENCE, CIRCLE, "Fence changed, items: 1"),
        (MissionType.RALLY, RALLY_POINT, "Rally changed, items: 1"),
    ],
)
def test_an_upload_of_anybody_is_reported_to_all(kind: MissionType, item: Item, text: str) -> None:
    field = Field()
    assert upload(field, item, kind=kind, system=OTHER) == MissionResult.ACCEPTED
    field.wait(0.5)
    assert field.texts.count(text) == 1
    number = next(
        n for n, each in enumerate(field.sent) if isinstance(each, m.StatusText) and m.decode_text(each) == text
    )
    assert field.peers[number] is None


def test_the_loss_of_a_fence_is_reported_and_that_of_none_is_not() -> None:
    """While FENCE_ENABLE is 1, too. QGroundControl clears fence and rally points with each mission without them."""
    field = Field(FENCE_ENABLE=1)
    field.say(m.MissionClearAll(1, 1, MissionType.ALL), OTHER)
    field.wait(0.5)
    assert not said(field, "cleared")
    assert upload(field, CIRCLE, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    field.say(m.MissionClearAll(1, 1, MissionType.ALL), OTHER)
    field.wait(0.5)
    assert said(field, "Fence cleared")
    assert not said(field, "Mission cleared")


def test_a_plan_that_is_removed_as_a_file_is_reported() -> None:
    field = Field()
    assert upload(field, way(1.0, 0.0), way(2.0, 0.0)) == MissionResult.ACCEPTED
    assert b"QGC WPL" in fetch(field, b"/missions/mission.waypoints")
    assert ask(field, FtpOpcode.REMOVE, b"/missions/mission.waypoints").op == FtpOpcode.ACK
    field.wait(0.5)
    assert said(field, "Mission cleared")


def test_nobody_but_the_driver_changes_a_plan() -> None:
    field = Field()
    assert upload(field, CIRCLE, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    field.arm()
    field.texts.clear()
    field.say(m.MissionClearAll(1, 1, MissionType.FENCE), OTHER)
    assert field.newest(m.MissionAck).type == MissionResult.DENIED
    field.wait(0.5)
    assert said(field, f"GCS {OTHER}: fence not changed: GCS {DRIVER} is in control")
    assert not said(field, "cleared")
