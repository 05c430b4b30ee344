"""Imports asyncio without OpenSSL, for the entry points of programs.

asyncio imports `ssl` for its transports with TLS, which no program here uses, and does without where it is missing. It
costs 6 ms of each start and 4 MiB of each process. `import ssl` works as usual afterwards, and so do libraries with TLS
of their own; only the `ssl` arguments of asyncio raise RuntimeError.
"""

from __future__ import annotations

import sys
from typing import Any


def load() -> None:
    """Import asyncio without `ssl`. Does nothing after the first import of either."""
    modules: dict[str, Any] = sys.modules
    if "asyncio" in modules or "ssl" in modules:
        return
    modules["ssl"] = None  # the import system's own way to say that a module cannot be imported
    try:
        import asyncio  # noqa: F401
    finally:
        del modules["ssl"]
