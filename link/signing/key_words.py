"""A key as 24 words to read aloud and type: BIP-39, whose word list and checksum come from the package `mnemonic`.

The first four letters tell its 2048 English words apart, and 8 bits of checksum find 255 of 256 mistakes.
https://github.com/bitcoin/bips/blob/master/bip-0039.mediawiki
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

from link.signing.missing_package import MissingPackageError

if TYPE_CHECKING:
    from mnemonic import Mnemonic

WORDS = 24
"""Words of 32 bytes: 256 bits and 8 of checksum, 11 a word."""
UNIQUE = 4
"""Letters that tell all words apart."""


class WordsError(ValueError):
    """These words are not a key; one line that repeats none of them."""


def words_from_secret(secret: bytes) -> tuple[str, ...]:
    """Return the words of a secret. Raises MissingPackageError."""
    return tuple(_book().to_mnemonic(secret).split())


def secret_from_words(words: Sequence[str]) -> bytes:
    """Return the secret of whole words. Raises WordsError, MissingPackageError."""
    if len(words) != WORDS:
        raise WordsError(f"a key has {WORDS} words, these are {len(words)}")
    try:
        return bytes(_book().to_entropy(list(words)))
    except (ValueError, LookupError):
        raise WordsError("the checksum is wrong: a word is another one, or two are swapped; type all again") from None


def complete_word(text: str) -> str | None:
    """Return the word that begins with these letters, at least four or the whole word; None if there is none.

    Raises MissingPackageError.
    """
    found = [word for word in _book().wordlist if word.startswith(text)] if len(text) >= UNIQUE else []
    if text in _book().wordlist:
        return text
    return found[0] if len(found) == 1 else None


@cache
def _book() -> Mnemonic:
    try:
        from mnemonic import Mnemonic
    except ImportError:
        raise MissingPackageError("words need", "mnemonic") from None
    return Mnemonic("english")
