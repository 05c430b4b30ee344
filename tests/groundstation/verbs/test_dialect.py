"""--dialect of the verbs."""

from __future__ import annotations

import pytest

from tests.groundstation.verbs.verb_runs import run_verb


def test_a_file_with_a_mistake_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    run = run_verb(capsys, "modes", "--dialect", "nowhere.xml")
    assert (run.code, run.out) == (2, "")
    assert run.err == "mavhelm: nowhere.xml: no such file: name the XML file of the dialect\n"
