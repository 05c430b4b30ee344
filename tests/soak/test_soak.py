"""A minute of the soak that docs/reliability.md describes, and some minutes of virtual time."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.soak.rules import OBEYED
from tests.soak.soak import Soak
from tests.soak.strict import RESOLUTION
from tests.soak.virtual import VirtualSoak

pytestmark = pytest.mark.slow


@pytest.mark.e2e
def test_a_minute_with_bad_links_and_killed_programs(tmp_path: Path) -> None:
    """Without a terminal, which would take as much of the processor as all the rest."""
    soak = Soak(tmp_path, 60.0, seed=1, keys=False)
    soak.run()
    report = soak.report()
    assert report["faults"] == [], json.dumps(report, indent=1)
    assert len(soak.findings.kills) >= 4, "every program in turn"


def test_two_minutes_of_virtual_time() -> None:
    soak = VirtualSoak(120.0, seed=1)
    soak.run()
    assert soak.findings.faults == []
    assert soak.findings.turned > 30.0
    arrived, sent = soak.oldest_obeyed
    assert 0.1 < arrived <= sent <= OBEYED + RESOLUTION
