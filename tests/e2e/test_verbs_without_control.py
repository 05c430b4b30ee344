"""Exit codes of verbs with the real vehicle while another ground station is in control."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.e2e.programs import Vehicle
from tests.e2e.test_verbs_of_a_script import write_corner
from tests.groundstation.verbs.verb_runs import run_verb
from tests.ports import free_port

pytestmark = pytest.mark.e2e


def test_what_needs_control_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    corner, params, port = tmp_path / "corner.waypoints", tmp_path / "rover.param", free_port()
    write_corner(corner)
    params.write_text("WP_RADIUS 1.25\n")
    needs_control = (
        ("arm",),
        ("mode", "MANUAL"),
        ("param", "set", "WP_RADIUS", "1.5"),
        ("param", "load", str(params)),
        ("param", "store"),
        ("param", "reset", "--yes"),
        ("mission", "put", str(corner)),
        ("calibrate", "gyro"),
        ("reboot",),
    )
    vehicle = Vehicle(tmp_path, port, "--param", "FS_GCS_TIMEOUT=60", "--param", "REBOOT_ENABLE=1")
    where = ("-e", f"udpin:127.0.0.1:{port}", "-v", "1", "--wait", "30")
    try:
        assert run_verb(capsys, "control", "request", *where).code == 0
        assert {
            words: run_verb(capsys, *words, *where, "--system", "100").code for words in needs_control
        } == dict.fromkeys(needs_control, ExitCode.NOT_IN_CONTROL)
        for words in needs_control[1:]:  # and with the session that is in control
            own = run_verb(capsys, *words, *where)
            assert own.code == 0 or "nothing is saved in this run" in own.err, own.err
    finally:
        vehicle.end()
