"""A key as words."""

from __future__ import annotations

import sys

import pytest

from link.signing import key_words
from link.signing.key_words import WordsError, complete_word, secret_from_words, words_from_secret
from link.signing.missing_package import MissingPackageError

ZERO = ("abandon",) * 23 + ("art",)
"""The test vector of BIP-39 for 32 zero bytes."""


@pytest.fixture(autouse=True)
def _packages() -> None:
    pytest.importorskip("mnemonic")


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


def test_a_missing_package_is_named_with_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    key_words._book.cache_clear()
    monkeypatch.setitem(sys.modules, "mnemonic", None)
    with pytest.raises(
        MissingPackageError, match=r"^words need the package mnemonic: .*\[keys\].*; --hex does without$"
    ):
        words_from_secret(bytes(32))
    monkeypatch.undo()
    assert words_from_secret(bytes(32)) == ZERO
