"""Plans as values of a program, and as files."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation import Fence, Mission, Rally
from groundstation.rover import InvalidCall

PATROL = Path(__file__).parents[3] / "docs" / "examples" / "patrol.plan"


@pytest.mark.parametrize("suffix", [".plan", ".waypoints"])
def test_a_mission_comes_back_from_its_file(tmp_path: Path, suffix: str) -> None:
    mission = Mission.through([(-35.5, 149.25), (1.5, -2.25)])
    mission.save(tmp_path / f"a{suffix}")
    assert Mission.load(tmp_path / f"a{suffix}") == mission
    assert mission.items[-1].longitude == -2.25


def test_a_file_has_the_kinds_that_it_names(tmp_path: Path) -> None:
    assert Mission.load(PATROL).items
    assert len(Fence.load(PATROL).items) == 4
    Fence.load(PATROL).save(tmp_path / "fence.plan")
    assert Fence.load(tmp_path / "fence.plan") == Fence.load(PATROL)
    with pytest.raises(InvalidCall, match="no mission in it"):
        Mission.load(tmp_path / "fence.plan")


@pytest.mark.parametrize("data", [b"QGC", b"\xff\xfe", b"", b"[1]"])
def test_what_is_no_plan_is_one_line(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "bad.plan").write_bytes(data)
    with pytest.raises(InvalidCall, match=r"bad\.plan") as caught:
        Rally.load(tmp_path / "bad.plan")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("place", [(91.0, 0.0), (0.0, 181.0), (float("nan"), 0.0)])
def test_places_that_are_nowhere_are_refused(place: tuple[float, float]) -> None:
    with pytest.raises(InvalidCall, match="is not a place"):
        Mission.through([place])
