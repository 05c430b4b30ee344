"""What the terminal and the locale can show, before the screen opens."""

from __future__ import annotations

import contextlib
import locale
import os
import sys
from collections.abc import Mapping


def needs_ascii(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether boxes and braille would not show: no UTF-8 locale, or the Linux console, which has no glyphs."""
    return environment.get("TERM") == "linux" or not _has_utf8(environment)


def _has_utf8(environment: Mapping[str, str]) -> bool:
    """Return whether the user's locale has UTF-8. Python itself replaces the locale C by C.UTF-8 (PEP 538)."""
    coerced = sys.flags.utf8_mode and environment.get("LC_CTYPE") == "C.UTF-8" and not environment.get("LC_ALL")
    if coerced:
        return False
    with contextlib.suppress(locale.Error):  # a locale that is not installed counts as C
        locale.setlocale(locale.LC_CTYPE, "")
    return locale.nl_langinfo(locale.CODESET).upper().replace("-", "") == "UTF8"
