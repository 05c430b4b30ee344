"""Child processes of our own programs: their environment, their end."""

from __future__ import annotations

import signal
import subprocess
import tempfile
from pathlib import Path

import pytest

from link.runtime.child_process import end_process, start_module


@pytest.mark.e2e
def test_a_module_runs_beside_a_package_of_the_same_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "groundstation").mkdir()
    (tmp_path / "groundstation" / "__init__.py").write_text("raise SystemExit(9)")
    monkeypatch.chdir(tmp_path)
    with tempfile.TemporaryFile() as output:
        process = start_module("groundstation", ["--version"], output=output)
        assert end_process(process, 60.0) == 0
        output.seek(0)
        assert output.read().startswith(b"mavhelm 0.")


@pytest.mark.e2e
def test_a_process_that_does_not_end_is_killed() -> None:
    process = subprocess.Popen(["sleep", "60"])
    assert end_process(process, 0.01) == -signal.SIGKILL
