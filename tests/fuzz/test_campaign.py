"""The campaign counts what its children did, and tells of an input that raised."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest

from tests.fuzz import engine
from tests.fuzz.campaign import Campaign


def test_each_target_gets_its_turn_and_its_figures(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def run(target: str, minutes: float, seed: int, grown: Path, memory: int) -> None:
        while time.process_time() < 0.05:
            pass
        os.write(1, b"INFO: ...\nstat::number_of_executed_units: 7\n")
        os._exit(77 if target == "tlog" else 0)

    monkeypatch.setattr(engine, "run", run)
    report = tmp_path / "report.json"
    campaign = Campaign(["framer", "tlog"], 1, tmp_path, 100, report)
    while not campaign.tallies["tlog"].turns:
        campaign.run(0.005, 0.001)
    framer, tlog = campaign.tallies.values()
    assert (framer.inputs, framer.failed, tlog.failed) == (7 * framer.turns, 0, tlog.turns)
    assert framer.cpu > 0.04 * framer.turns > 0.0
    assert campaign.failed
    assert json.loads(report.read_text())["framer"]["inputs"] > 0
    assert "framer" in campaign.table()
