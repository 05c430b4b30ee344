"""What `mavhelm bridge router` says of those who connect."""

from __future__ import annotations

import logging
import time
from pathlib import Path

import pytest
import zenoh

from link.bridge.fleet.fleet_file import FILE, read_fleet_file
from link.bridge.fleet.router_command import _log_link, _open
from link.endpoint import parse_endpoint
from link.fleet.config import load_config
from tests.e2e.fleet_programs import make_fleet
from tests.waits import PATIENCE


@pytest.mark.parametrize("quic", [False, True])
def test_a_program_is_logged_once_as_it_comes_and_as_it_goes(
    quic: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = make_fleet(tmp_path, quic=quic, rover1="vehicle")
    fleet = read_fleet_file(folder / FILE)
    caplog.set_level(logging.INFO)

    def wait_for(text: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while text not in caplog.text:
            assert time.monotonic() < deadline

    with _open(fleet, folder, []) as router:
        events = router.info.declare_link_events_listener(_log_link(fleet), history=True)
        with zenoh.open(load_config(parse_endpoint(f"zenoh:{folder}/rover1.json5/farm/rover1")).zenoh) as session:
            assert len(session.info.links()) == 1 + quic
            wait_for("rover1 from")
        wait_for("rover1 has gone from")
        events.undeclare()
    lines = [each.getMessage().split(" from ")[0] for each in caplog.records if "rover1" in each.getMessage()]
    assert lines == ["vehicle rover1", "vehicle rover1 has gone"]
