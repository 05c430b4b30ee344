"""Child processes of our own programs: their environment, their end."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from link.runtime.child_process import end_process, start_module
from tests.groundstation.screen import running
from tests.waits import wait_until

PARENT = """
import os
from link.runtime import child_process
child_process.KERNEL_TELLS_OF_DEATH = {kernel}
if not {kernel}:
    child_process._life_line()
    if not os.fork():
        input()  # a fork that lives on, as a watchdog does
child = child_process.start_module("http.server", ["--bind", "127.0.0.1", "0"], ends_with_us=True)
print(child.pid, flush=True)
input()
"""


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


@pytest.mark.e2e
@pytest.mark.parametrize("kernel", [True, False], ids=["prctl", "pipe"])
def test_a_child_ends_with_a_parent_that_is_killed(kernel: bool) -> None:
    code = PARENT.format(kernel=kernel)
    with subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        assert running(child)
        parent.kill()
        wait_until(lambda: not running(child))


@pytest.mark.e2e
@pytest.mark.parametrize("kernel", [True, False], ids=["prctl", "pipe"])
def test_a_child_that_ends_with_us_has_its_arguments(kernel: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("link.runtime.child_process.KERNEL_TELLS_OF_DEATH", kernel)
    with tempfile.TemporaryFile() as output:
        process = start_module("groundstation", ["--version"], output=output, ends_with_us=True)
        assert end_process(process, 60.0) == 0
        output.seek(0)
        assert output.read().startswith(b"mavhelm 0.")
