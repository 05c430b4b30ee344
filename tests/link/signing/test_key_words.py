"""A key as words and as a QR code."""

from __future__ import annotations

import pytest

from link.signing.key_input import read_words
from link.signing.key_qr import draw_qr
from link.signing.key_words import WordsError, complete_word, secret_from_words, words_from_secret

ZERO = ("abandon",) * 23 + ("art",)
"""The test vector of BIP-39 for 32 zero bytes."""


@pytest.fixture(autouse=True)
def _packages() -> None:
    pytest.importorskip("mnemonic")
    pytest.importorskip("segno")


def test_the_vectors_of_bip_39() -> None:
    assert words_from_secret(bytes(32)) == ZERO
    assert secret_from_words(ZERO) == bytes(32)
    assert words_from_secret(b"\x7f" * 32)[-1] == "title"


def test_words_come_back_and_a_wrong_one_is_found() -> None:
    secret = bytes(range(32))
    words = words_from_secret(secret)
    assert secret_from_words(words) == secret
    with pytest.raises(WordsError, match="checksum"):
        secret_from_words((words[1], words[0], *words[2:]))
    with pytest.raises(WordsError, match="these are 23"):
        secret_from_words(words[1:])
    with pytest.raises(WordsError):
        secret_from_words(("nosuchword", *words[1:]))


@pytest.mark.parametrize(
    ("text", "word"), [("aban", "abandon"), ("art", "art"), ("aba", None), ("zzzz", None), ("", None)]
)
def test_four_letters_are_enough(text: str, word: str | None) -> None:
    assert complete_word(text) == word


def test_typed_words_are_checked_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    lines = iter(["ABANDON aban", "wrnog", *ZERO[2:]])
    assert read_words(lambda prompt: next(lines)) == bytes(32)
    assert "word 3 is not in the list" in capsys.readouterr().err


def test_a_qr_code_has_its_quiet_zone_and_fits_a_terminal() -> None:
    lines = draw_qr("AB" * 32, unicode=True).splitlines()
    assert len(lines) == 19
    assert all(line.startswith("\x1b[30;107m") and line.endswith("\x1b[0m") for line in lines)
    width = len(lines[0].removeprefix("\x1b[30;107m").removesuffix("\x1b[0m"))
    assert width == 37
    assert not lines[0].removeprefix("\x1b[30;107m").removesuffix("\x1b[0m").strip()
    assert "▀" not in draw_qr("AB" * 32, unicode=False)
