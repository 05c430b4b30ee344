"""The programs that speak, in the order in which they are looked for, and texts that are safe for them."""

from __future__ import annotations

import shutil

import msgspec

LONGEST = 200
"""Characters of an announcement."""


class SpeechProgram(msgspec.Struct, frozen=True):
    """One program. It ends when it has spoken, and its end silences it, unless `cancel` is needed for that."""

    words: tuple[str, ...]
    """The command; the text follows."""
    cancel: tuple[str, ...] = ()
    """What silences a server that goes on when its client has ended."""


PROGRAMS = (
    SpeechProgram(
        ("spd-say", "--wait", "--application-name", "mavhelm", "--priority", "important", "--"), ("spd-say", "--cancel")
    ),
    SpeechProgram(("espeak-ng", "--")),
    SpeechProgram(("say",)),
)
"""speech-dispatcher first: a screen reader speaks by it, too, with the voice and rate of the user. `say` is macOS's."""


def find_program() -> SpeechProgram | None:
    """Return the first one on PATH."""
    return next((each for each in PROGRAMS if shutil.which(each.words[0])), None)


def missing_program() -> str:
    """Return that there is none, and what to do, in one line."""
    names = ", ".join(each.words[0] for each in PROGRAMS)
    return f"--speak: none of {names} is installed: on Debian `apt install speech-dispatcher` or espeak-ng"


def safe_text(text: str) -> str:
    """Return a text of a vehicle without what programs take for options or commands, and not too long."""
    words = "".join(each if each.isprintable() and each not in "[]<>" else " " for each in text).split()
    return " ".join(words)[:LONGEST].lstrip("-")
