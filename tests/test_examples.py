"""The programs of docs/examples, run against the real vehicle over loopback."""

from __future__ import annotations

import importlib.util
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from tests.e2e.programs import Vehicle
from tests.ports import free_port
from tests.vehicle.motors.contract import Bench, MotorsContract
from tests.waits import PATIENCE

EXAMPLES = Path(__file__).parents[1] / "docs" / "examples"
Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def start() -> Iterator[Start]:
    """Start an example with its words; it ends with the test."""
    with ExitStack() as stack:

        def begin(name: str, *words: str) -> subprocess.Popen[str]:
            process = subprocess.Popen(
                [sys.executable, str(EXAMPLES / name), *words],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
            stack.callback(process.communicate)
            stack.callback(process.kill)
            return process

        yield begin


@pytest.fixture
def vehicle(tmp_path: Path) -> Iterator[Callable[..., Vehicle]]:
    """Start a simulated rover with its endpoint; it ends with the test."""
    with ExitStack() as stack:

        def begin(*words: str) -> Vehicle:
            started = Vehicle(tmp_path, *words)
            stack.callback(started.end)
            return started

        yield begin


@pytest.mark.e2e
@pytest.mark.slow
def test_drive_square_reaches_each_corner_and_logs_it(
    tmp_path: Path, start: Start, vehicle: Callable[..., Vehicle]
) -> None:
    port = free_port()
    rover = vehicle(f"udpout:127.0.0.1:{port}", "--tlog", str(tmp_path / "logs"))
    driving = start("drive_square.py", f"udpin:127.0.0.1:{port}")
    told, _ = driving.communicate(timeout=PATIENCE)
    assert driving.returncode == 0, told
    assert told.count("corner") == 4
    assert any(each.turning for each in rover.outputs())
    assert not rover.outputs()[-1].turning
    [log] = (tmp_path / "logs").glob("*.tlog")
    counted, _ = start("read_log.py", str(log)).communicate(timeout=PATIENCE)
    assert "Armed" in counted or "armed" in counted
    assert "MANUAL_CONTROL" in counted


@pytest.mark.e2e
@pytest.mark.slow
def test_the_notebook_runs_and_the_rover_gets_there() -> None:
    nbclient = pytest.importorskip("nbclient", reason="the extra `notebook` is not installed")
    nbformat = pytest.importorskip("nbformat", reason="the extra `notebook` is not installed")
    pytest.importorskip("ipykernel", reason="the extra `notebook` is not installed")
    notebook = nbformat.read(EXAMPLES / "drive.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs belong to who has run it"
    nbclient.NotebookClient(notebook, timeout=4 * PATIENCE, kernel_name="python3").execute()
    outputs = {
        cell.id: "".join(each.get("text") or each.data["text/plain"] for each in cell.outputs)
        for cell in notebook.cells
        if cell.cell_type == "code"
    }
    assert "Position(latitude=" in outputs["open"]
    assert outputs["drive"].startswith("turned by")
    assert outputs["auto"] == "'HOLD'"


@pytest.mark.e2e
def test_bridge_two_links_forwards_what_the_vehicle_sends(start: Start, vehicle: Callable[..., Vehicle]) -> None:
    near, far = free_port(), free_port()
    bridge = start("bridge_two_links.py", f"udpin:127.0.0.1:{near}", f"udpout:127.0.0.1:{far}")
    vehicle(f"udpout:127.0.0.1:{near}")
    deadline = time.monotonic() + PATIENCE
    line = ""
    while " 0 frames/s" in line.partition("|")[0] or not line:
        assert time.monotonic() < deadline, line
        assert bridge.stdout is not None
        assert select.select([bridge.stdout], [], [], PATIENCE)[0]
        line = bridge.stdout.readline()
    bridge.send_signal(signal.SIGINT)
    bridge.communicate(timeout=PATIENCE)
    assert bridge.returncode == 0


@pytest.mark.e2e
def test_values_of_own_sensor_reach_a_ground_station(start: Start, vehicle: Callable[..., Vehicle]) -> None:
    ground, beside = free_port(), free_port()
    vehicle(f"udpout:127.0.0.1:{ground}", f"udpin:127.0.0.1:{beside}")
    start("own_sensor.py", f"udpout:127.0.0.1:{beside}")
    where = ["-e", f"udpin:127.0.0.1:{ground}", "--station", "never", "--timeout", str(PATIENCE)]
    watched = subprocess.run(
        [sys.executable, "-m", "groundstation", "watch", "NAMED_VALUE_FLOAT.value", "--until", ">=0", *where],
        capture_output=True,
        text=True,
        check=False,
    )
    assert watched.returncode == 0, watched.stdout + watched.stderr


class TestMyMotors(MotorsContract):
    @pytest.fixture
    def bench(self) -> Bench:
        motors = _load("my_motors").PrintMotors()
        return Bench(motors, lambda: motors.throttles if motors.enabled else motors.neutral, lambda: motors.enabled)


def test_the_vehicle_takes_my_motors_by_name(tmp_path: Path) -> None:
    settings = tmp_path / "rover.toml"
    settings.write_text(f'endpoints = ["udpin:127.0.0.1:{free_port()}"]\n[motors]\ndriver = "my_motors:PrintMotors"\n')
    checked = subprocess.run(
        [sys.executable, "-m", "vehicle", "check", str(settings)],
        env={**os.environ, "PYTHONPATH": str(EXAMPLES)},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "my_motors:PrintMotors with 2 motors" in checked.stdout


def _load(name: str) -> Any:
    """Import an example, which is not a module of a package."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_tested() -> None:
    """Here, or with ROS 1."""
    tested = "".join(file.read_text() for file in (Path(__file__), Path(__file__).parent / "e2e" / "test_ros1.py"))
    assert all(example.stem in tested for example in EXAMPLES.glob("*.py"))
