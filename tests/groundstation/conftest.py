"""Fixtures of the ground station's tests."""

from __future__ import annotations

import pytest

from groundstation import client as client_module
from tests.groundstation.screen import PATIENCE


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A station may take its time to end."""
    monkeypatch.setattr(client_module, "CLOSE_TIMEOUT", PATIENCE)
