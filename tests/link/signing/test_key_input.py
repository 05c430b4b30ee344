"""Secrets from a terminal, a pipe or a file; each mistake is one line that does not repeat what was typed."""

from __future__ import annotations

import getpass
import hashlib
import io
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from link.signing.key_input import (
    Ask,
    SecretForm,
    SecretInputError,
    read_hex,
    read_passphrase,
    read_secret,
    read_words,
)
from link.signing.keys import PassphraseKind

HEX = "ab" * 32
ZERO = ("abandon",) * 23 + ("art",)
"""The words of 32 zero bytes."""


class Typed:
    """Answers prompts with lines, and keeps the prompts."""

    def __init__(self, lines: Iterable[str]) -> None:
        self.prompts: list[str] = []
        self._lines = iter(lines)

    def __call__(self, prompt: str) -> str:
        self.prompts.append(prompt)
        try:
            return next(self._lines)
        except StopIteration:
            raise EOFError from None


class Terminal(io.TextIOWrapper):
    """Standard input as a terminal."""

    def isatty(self) -> bool:
        return True


def type_in(monkeypatch: pytest.MonkeyPatch, data: bytes, stream: Callable[..., io.TextIOWrapper]) -> None:
    monkeypatch.setattr(sys, "stdin", stream(io.BytesIO(data)))


def error_of(read: Callable[[], bytes]) -> str:
    with pytest.raises(SecretInputError) as caught:
        read()
    assert "\n" not in str(caught.value)
    return str(caught.value)


# ---- hex digits ----


def test_hex_digits_may_have_spaces_and_line_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "secret"
    file.write_text(f" {HEX[:20]}\n{HEX[20:]}\r\n")
    assert read_hex(str(file)) == bytes.fromhex(HEX)
    type_in(monkeypatch, HEX.upper().encode(), io.TextIOWrapper)
    assert read_hex("-") == bytes.fromhex(HEX)


def test_hex_digits_end_after_4096_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for size, count in ((4096, 2048), (4098, 2048)):
        type_in(monkeypatch, b"a" * size, io.TextIOWrapper)
        assert len(read_hex("-")) == count
    file = tmp_path / "secret"
    file.write_bytes(b"a" * 4096)
    assert len(read_hex(str(file))) == 2048
    file.write_bytes(b"a" * 4097)
    assert error_of(lambda: read_hex(str(file))) == f"{file}: is larger than 4096 bytes"


@pytest.mark.parametrize("data", [b"zz", b"abc", b"\xff\xff", "\u0661\u0661".encode()])
def test_other_bytes_are_named_with_their_source(data: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "secret"
    file.write_bytes(data)
    assert error_of(lambda: read_hex(str(file))) == f"{file}: this is not 64 hex digits"
    type_in(monkeypatch, data, io.TextIOWrapper)
    assert error_of(lambda: read_hex("-")) == "standard input: this is not 64 hex digits"
    assert error_of(lambda: read_hex(str(tmp_path / "none"))) == f"{tmp_path / 'none'}: No such file or directory"


# ---- words ----


def test_words_are_asked_for_by_their_number(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mnemonic")
    typed = Typed(["ABANDON aban", "", "abandon wrnog abandon", *ZERO[3:]])
    assert read_words(typed) == bytes(32)
    assert typed.prompts[:4] == ["word 1 of 24: ", "word 3 of 24: ", "word 3 of 24: ", "word 4 of 24: "]
    assert capsys.readouterr().err == "word 4 is not in the list; type it again, and those after it\n"


def test_wrong_words_are_one_line() -> None:
    pytest.importorskip("mnemonic")
    assert "the checksum is wrong" in error_of(lambda: read_words(Typed(("abandon",) * 24)))
    assert "these are 25" in error_of(lambda: read_words(Typed([*ZERO[:23], "art art"])))


# ---- passphrases ----


def test_each_kind_of_passphrase_has_its_own_secret() -> None:
    typed = Typed(["secret_key"] * 2)
    assert read_secret(SecretForm.PASSPHRASE, ask=typed) == hashlib.sha256(b"secret_key").digest()
    salt = b"QGroundControl-MAVLink-Signing-v1"
    qgc = hashlib.pbkdf2_hmac("sha256", b"secret_key", salt, 600_000, 32)
    assert read_secret(SecretForm.QGC_PASSPHRASE, ask=typed) == qgc
    assert typed.prompts == ["passphrase: "] * 2


def test_a_passphrase_has_eight_characters_of_text() -> None:
    def read(text: str) -> bytes:
        return read_passphrase(Typed([text]), PassphraseKind.SHA256)

    assert read("12345678") == hashlib.sha256(b"12345678").digest()
    assert error_of(lambda: read("1234567")) == "a passphrase has at least 8 characters; better are six random words"
    assert "bytes" in error_of(lambda: read("12345678\udcff"))


# ---- where it comes from ----


def test_a_terminal_is_asked_without_echo(monkeypatch: pytest.MonkeyPatch) -> None:
    type_in(monkeypatch, b"not this one\n", Terminal)
    asked: Ask = Typed(["secret_key"])
    monkeypatch.setattr(getpass, "getpass", asked)
    assert read_secret(SecretForm.PASSPHRASE) == hashlib.sha256(b"secret_key").digest()


@pytest.mark.parametrize("end", [b"", b"\n", b"\r\n"])
def test_a_pipe_is_read_to_the_end_of_its_line(end: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    type_in(monkeypatch, b"secret key " + end, lambda data: io.TextIOWrapper(data, newline=""))
    assert read_secret(SecretForm.PASSPHRASE) == hashlib.sha256(b"secret key ").digest()


def test_an_input_that_ends_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    type_in(monkeypatch, b"", io.TextIOWrapper)
    ended = "the input has ended; nothing was changed"
    assert error_of(lambda: read_secret(SecretForm.PASSPHRASE)) == ended
    assert error_of(lambda: read_secret(SecretForm.WORDS, ask=Typed([]))) == ended


def test_a_secret_that_no_key_may_have_is_one_line(tmp_path: Path) -> None:
    file = tmp_path / "secret"
    file.write_text("abcd")
    assert error_of(lambda: read_secret(SecretForm.HEX, str(file))) == "a key has 32 bytes, this one has 2"
    file.write_text("00" * 32)
    assert "32 zero bytes" in error_of(lambda: read_secret(SecretForm.HEX, str(file)))
    file.write_text(HEX)
    assert read_secret(SecretForm.HEX, str(file)) == bytes.fromhex(HEX)


def test_hex_digits_come_from_standard_input_by_default(monkeypatch: pytest.MonkeyPatch) -> None:
    type_in(monkeypatch, HEX.encode(), io.TextIOWrapper)
    assert read_secret(SecretForm.HEX) == bytes.fromhex(HEX)
