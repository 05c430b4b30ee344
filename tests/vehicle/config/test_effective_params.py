"""The state folder that vehicle check and motor-test use."""

from __future__ import annotations

from pathlib import Path

import pytest

from vehicle.config import effective_params


def test_where_the_programs_beside_a_vehicle_look(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setattr(effective_params, "SERVICE", tmp_path / "service")
    assert effective_params.state_folder_of(None) == tmp_path / "home" / "mavhelm"
    (tmp_path / "service").symlink_to("/no/such/folder")  # of a user that exists only while the service runs
    assert effective_params.state_folder_of(None) == tmp_path / "service"
    monkeypatch.setenv("STATE_DIRECTORY", "/run/one:/run/two")
    assert effective_params.state_folder_of(None) == Path("/run/one")
    assert effective_params.state_folder_of("/srv/rover") == Path("/srv/rover")
