"""Reads a secret: words, a passphrase, or hex digits; from the terminal without showing them, or from a pipe.

Nothing is taken from the command line, which every user of the computer can read while the program runs.
"""

from __future__ import annotations

import getpass
import sys
from collections.abc import Callable
from enum import Enum
from pathlib import Path

from link.signing.key_words import WORDS, WordsError, complete_word, secret_from_words
from link.signing.keys import PassphraseKind, find_secret_problem, key_from_passphrase
from link.toml.file import read_regular_file

MAX_HEX = 4096
"""Bytes of a file or pipe with hex digits: far more than the 64 digits, with spaces and line ends."""
SHORTEST_PASSPHRASE = 8
"""Characters; QGroundControl asks for as many. Guessing needs one recorded frame and no contact to the vehicle."""
STDIN = "-"


class SecretInputError(Exception):
    """What was entered is not a key; one line without the secret."""


class SecretForm(Enum):
    """How a secret is entered."""

    WORDS = "words"
    PASSPHRASE = "passphrase"
    QGC_PASSPHRASE = "qgc-passphrase"
    HEX = "hex"


Ask = Callable[[str], str]
"""Shows a prompt and returns a line. Raises EOFError."""


def read_secret(form: SecretForm, file: str = STDIN, ask: Ask | None = None) -> bytes:
    """Return the secret that the user enters. `file` is for HEX. Raises SecretInputError, MissingPackageError."""
    ask = ask or (getpass.getpass if sys.stdin.isatty() else _read_line)
    try:
        secret = read_hex(file) if form is SecretForm.HEX else _READERS[form](ask)
    except EOFError:
        raise SecretInputError("the input has ended; nothing was changed") from None
    if problem := find_secret_problem(secret):
        raise SecretInputError(problem)
    return secret


def read_hex(file: str) -> bytes:
    """Return the bytes of hex digits in a file, or in standard input for `-`. Raises SecretInputError."""
    try:
        data = sys.stdin.buffer.read(MAX_HEX) if file == STDIN else read_regular_file(Path(file), MAX_HEX)
    except OSError as error:
        raise SecretInputError(f"{file}: {error.strerror}") from error
    try:
        return bytes.fromhex("".join(data.decode("ascii").split()))
    except ValueError:
        name = "standard input" if file == STDIN else file
        raise SecretInputError(f"{name}: this is not 64 hex digits") from None


def read_words(ask: Ask) -> bytes:
    """Return the secret of 24 words, one or more a line; four letters of each are enough. Raises EOFError."""
    words: list[str] = []
    while len(words) < WORDS:
        for text in ask(f"word {len(words) + 1} of {WORDS}: ").lower().split():
            word = complete_word(text)
            if word is None:
                sys.stderr.write(f"word {len(words) + 1} is not in the list; type it again, and those after it\n")
                break
            words.append(word)
    try:
        return secret_from_words(words)
    except WordsError as error:
        raise SecretInputError(str(error)) from None


def read_passphrase(ask: Ask, kind: PassphraseKind) -> bytes:
    """Return the secret that other ground stations make from the passphrase. Raises SecretInputError, EOFError."""
    text = ask("passphrase: ")
    if len(text) < SHORTEST_PASSPHRASE:
        raise SecretInputError(
            f"a passphrase has at least {SHORTEST_PASSPHRASE} characters; better are six random words"
        )
    try:
        return key_from_passphrase(text, kind)
    except UnicodeEncodeError:
        raise SecretInputError("the passphrase contains bytes that are not text") from None


_READERS: dict[SecretForm, Callable[[Ask], bytes]] = {
    SecretForm.WORDS: read_words,
    SecretForm.PASSPHRASE: lambda ask: read_passphrase(ask, PassphraseKind.SHA256),
    SecretForm.QGC_PASSPHRASE: lambda ask: read_passphrase(ask, PassphraseKind.PBKDF2),
}


def _read_line(prompt: str) -> str:
    line = sys.stdin.readline()
    if not line:
        raise EOFError
    return line.rstrip("\r\n")
