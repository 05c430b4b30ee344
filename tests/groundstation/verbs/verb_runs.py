"""Runs a verb in this process, and returns its exit code and what it printed."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import pytest

from groundstation.cli.main import main


@dataclass(frozen=True)
class VerbRun:
    """How a verb ended."""

    code: int
    out: str
    err: str

    @property
    def records(self) -> list[Any]:
        """The JSON objects on stdout."""
        return [json.loads(line) for line in self.out.splitlines()]


def run_verb(capsys: pytest.CaptureFixture[str], *arguments: str) -> VerbRun:
    """Run `groundstation arguments`."""
    capsys.readouterr()
    try:
        code = main(arguments)
    except SystemExit as error:
        code = int(error.code or 0)
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return VerbRun(code, captured.out, captured.err)
