"""Fixtures of the ground station's tests."""

from __future__ import annotations

import pytest

from groundstation import client as client_module
from tests.waits import PATIENCE


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the station more time to exit."""
    monkeypatch.setattr(client_module, "CLOSE_TIMEOUT", PATIENCE)
