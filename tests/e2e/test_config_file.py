"""The real program with a config file: a named endpoint, its own keys, no colours, and what it remembers."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.recent.recent_file import RecentFile
from tests.e2e.programs import GroundStation
from tests.groundstation.ui.contrast import colour_codes
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e


def test_a_name_opens_its_endpoint_and_the_session_is_remembered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    config = tmp_path / "my.toml"
    config.write_text(f'theme = "light"\n[endpoints]\nfield = "{endpoint}"\n[keys]\napp.quit = "ctrl+t"\n')
    monkeypatch.setenv("MAVHELM_CONFIG", str(config))
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    station = GroundStation(tmp_path, "field")
    try:
        station.wait_for(lambda: endpoint.encode() in station.screen, PATIENCE, "the endpoint on the first page")
        station.type("\x14")
        assert station.ended() == 0
        assert b"\x1b[1m" in station.screen
        assert not colour_codes(station.screen) - {39, 49}, "39 and 49 are the terminal's own colours"
    finally:
        station.end()
    assert RecentFile(tmp_path / "state" / "mavhelm" / "recent.json").load().last == endpoint
