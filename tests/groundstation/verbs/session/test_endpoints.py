"""Where a verb looks for its vehicle: -e, MAVHELM_ENDPOINT, the config file, the endpoint used last, the default."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.config.defaults import DEFAULT_ENDPOINT
from groundstation.recent.recent_file import RecentFile
from groundstation.verbs.session import endpoints
from groundstation.verbs.session.endpoints import choose_endpoints
from tests.fakes.services import foreign_vehicle
from tests.groundstation.verbs.verb_runs import run_verb
from tests.ports import free_port

A, B, C = (f"udpin:127.0.0.1:{port}" for port in (14601, 14602, 14603))


@pytest.fixture
def recent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RecentFile:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return RecentFile()


def test_each_place_wins_over_the_next(recent: RecentFile, tmp_path: Path) -> None:
    assert choose_endpoints(None, None, {}, recent) == [DEFAULT_ENDPOINT]
    recent.update(lambda known: known.add(A, 1.0))
    assert choose_endpoints(None, None, {}, recent) == [A]
    config = tmp_path / "my.toml"
    config.write_text(f'open = "field"\n[endpoints]\nfield = "{B}"\n')
    assert choose_endpoints(None, str(config), {}, recent) == [B]
    assert choose_endpoints(None, str(config), {"MAVHELM_ENDPOINT": f"{C} field"}, recent) == [C, B]
    assert choose_endpoints([A, "field"], str(config), {"MAVHELM_ENDPOINT": C}, recent) == [A, B]


def test_a_broken_config_file_does_not_block_a_given_endpoint(recent: RecentFile, tmp_path: Path) -> None:
    (tmp_path / "my.toml").write_text("speed = 9")
    assert choose_endpoints([A], str(tmp_path / "my.toml"), {}, recent) == [A]


def test_the_next_verb_finds_the_vehicle_where_the_last_one_did(
    recent: RecentFile, capsys: pytest.CaptureFixture[str]
) -> None:
    with foreign_vehicle() as vehicle:
        assert run_verb(capsys, "modes", "-e", vehicle.endpoint, "-v", "1").code == 0
        [entry] = recent.load().entries
        assert (entry.endpoint, entry.vehicle) == (vehicle.endpoint, "ArduPilot rover 1")
        assert run_verb(capsys, "modes", "-v", "1").code == 0


def test_a_damaged_file_of_endpoints_is_one_note(
    recent: RecentFile, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(endpoints, "DEFAULT_ENDPOINT", f"udpin:127.0.0.1:{free_port()}")
    recent.path.parent.mkdir(parents=True)
    recent.path.write_text("{")
    lines = [run_verb(capsys, "modes", "--wait", "0.05").err.splitlines() for _ in range(2)]
    assert "was damaged and is now recent.json.damaged" in lines[0][0]
    assert [line[-1].split(" on ")[0] for line in lines] == ["mavhelm: no vehicle"] * 2
    assert len(lines[1]) == 1
