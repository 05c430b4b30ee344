"""What a screen shows of the aids for operators who do not look at it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from groundstation.ui.app.without_looking import Aids
from tests.groundstation.speech.spoken import Ear
from tests.groundstation.ui.pilots import console
from tests.waits import until


@pytest.mark.parametrize("size", [(80, 24), (60, 15)])
async def test_muted_speech_is_shown_until_it_is_on_again(
    size: tuple[int, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(Ear(tmp_path).folder), prepend=os.pathsep)
    async with console(size, aids=Aids(speak=True)) as screen:
        assert " muted" not in screen.text
        await screen.press("quotation_mark")
        await until(lambda: " muted" in screen.text.split("\n")[0])
        await screen.press("quotation_mark")
        await until(lambda: " muted" not in screen.text.split("\n")[0])


async def test_who_did_not_ask_for_speech_is_not_told_of_it() -> None:
    async with console() as screen:
        await screen.press("quotation_mark")
        assert " muted" not in screen.text.split("\n")[0]
