"""build_params: the precedence of parameters, and damaged files."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec.structs import replace

from tests.vehicle.storage.test_param_store import kept
from vehicle.config.run_settings import RunSettings, Simulation
from vehicle.runtime.factory import build_params
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore


def test_what_wins(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Kept over defaults, the file of settings over kept, this run over all."""
    kept(tmp_path, SPEED_MAX=2.0, TRACK_WIDTH=1.0, WHEELBASE=1.0, GONE=1.0, MAN_TIMEOUT=99.0)
    settings = RunSettings((), pinned={"TRACK_WIDTH": 2.0}, params={"WHEELBASE": 3.0})
    params = build_params(settings, ParamStore(FileWriter(tmp_path)))
    assert [params[name] for name in ("SPEED_MAX", "TRACK_WIDTH", "WHEELBASE", "MAN_TIMEOUT")] == [2.0, 2.0, 3.0, 0.45]
    assert params.pinned == {"TRACK_WIDTH"}
    assert params.run_values == {"WHEELBASE": 3.0}
    assert [record.levelname for record in caplog.records] == ["WARNING", "WARNING"]
    assert params.damage is None


def test_a_known_cars_parameters_are_its_defaults(tmp_path: Path) -> None:
    kept(tmp_path, MOT2_MAX=80.0)
    settings = RunSettings((), motors={"driver": "article-car"}, pinned={"MOT_PIVOT_MAX": 50.0})
    params = build_params(settings, ParamStore(FileWriter(tmp_path)))
    assert [params[name] for name in ("MOT1_MAX", "MOT2_MAX", "MOT_PIVOT_MAX")] == [60.0, 80.0, 50.0]
    simulated = build_params(replace(settings, simulation=Simulation()), ParamStore())
    assert simulated["MOT1_MAX"] == 100.0


def test_damage_reaches_the_arming_checks(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "parameters").write_text("half")
    assert build_params(RunSettings(()), ParamStore(FileWriter(tmp_path))).damage == "parameter file damaged"
    assert "arming is denied" in caplog.text


def test_damage_is_told_with_its_folder(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "parameters").write_text("half")
    build_params(RunSettings((), state=tmp_path), ParamStore(FileWriter(tmp_path)))
    assert f"{tmp_path}: parameter file damaged: all saved parameters" in caplog.text
