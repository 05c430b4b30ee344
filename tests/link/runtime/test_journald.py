"""Log levels are marked for the journal and nowhere else."""

from __future__ import annotations

import os

import pytest

from link.runtime import journald


def test_only_a_stderr_that_is_the_journal_gets_levels(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = os.fstat(journald.STDERR)
    monkeypatch.setenv("JOURNAL_STREAM", f"{stream.st_dev}:{stream.st_ino}")
    assert journald.priority_prefix(journald.ERROR) == "<3>"
    monkeypatch.setenv("JOURNAL_STREAM", f"{stream.st_dev}:{stream.st_ino + 1}")  # inherited, but not this stream
    assert journald.priority_prefix(journald.ERROR) == ""
    monkeypatch.delenv("JOURNAL_STREAM")
    assert journald.priority_prefix(journald.ERROR) == ""
