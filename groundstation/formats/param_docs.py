"""ParamDocs: the texts of parameters, the same for the files of all autopilots."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from functools import cached_property

from groundstation.views.params import ParamDoc

MAX_DOCS = 10_000
"""Parameters of one file; ten times what an autopilot has."""
MAX_TEXT = 4000
"""Characters of a text that are kept."""
MAX_CHOICES = 512
"""Values or bits of one parameter; ArduPilot's longest list has 190."""
_WORD = re.compile(r"\w+")


@dataclass(frozen=True)
class ParamDocs:
    """The texts of one file or one vehicle."""

    source: str = ""
    """Where they come from, e.g. "the vehicle" or "apm.pdef.xml"; empty: there are none."""
    docs: dict[str, ParamDoc] = field(default_factory=dict)
    """By name."""

    def get(self, name: str) -> ParamDoc:
        """Return what is known of a parameter, an empty description if that is nothing."""
        return self.docs.get(name) or ParamDoc(name)

    def search_text(self, name: str) -> str:
        """Return the words of the texts of a parameter in capitals, a space before each."""
        return self._search_texts.get(name, "")

    @cached_property
    def _search_texts(self) -> dict[str, str]:
        texts = ((name, f"{doc.title} {doc.text}".upper()) for name, doc in self.docs.items())
        return {name: " " + " ".join(_WORD.findall(text)) for name, text in texts}


def number_of(text: object) -> float | None:
    """Return a number of a file, None where it is none: files have texts such as "0-100" in its place."""
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        return None
    try:
        value = float(int(text, 16)) if isinstance(text, str) and text.lower().startswith("0x") else float(text)
    except (ValueError, OverflowError):
        return None
    return value if math.isfinite(value) else None


def text_of(value: object) -> str:
    """Return a text of a file in one line; another type is an empty text."""
    return " ".join(value[:MAX_TEXT].split()) if isinstance(value, str) else ""
