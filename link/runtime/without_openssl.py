"""Imports asyncio and hashlib without OpenSSL, for the entry points of programs.

asyncio imports `ssl` for its transports with TLS, which no program here uses, and does without where it is missing. It
costs 6 ms of each start and 4 MiB of each process. `import ssl` works as usual afterwards, and so do libraries with TLS
of their own; only the `ssl` arguments of asyncio raise RuntimeError.

hashlib and hmac import `_hashlib` for the hash functions of OpenSSL, and have the same ones of Python's own. Those cost
4 ms and 3 MiB less, and hash short texts such as MAVLink frames a third faster. hashlib.scrypt() and, from Python 3.12
on, pbkdf2_hmac() are missing then; `_hashlib` has them.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any

OWN_HASHES = (("_md5",), ("_sha1",), ("_sha2", "_sha256"), ("_sha2", "_sha512"), ("_sha3",), ("_blake2",))
"""Modules of Python's own hash functions, by Python 3.12 and by 3.11. A Python for FIPS may be built without them."""


def load() -> None:
    """Import asyncio without `ssl`, and hashlib without `_hashlib`. Does nothing for what is imported already."""
    _import_without("ssl", "asyncio")
    if all(any(map(_exists, names)) for names in OWN_HASHES):
        _import_without("_hashlib", "hashlib", "hmac")


def _import_without(left_out: str, *names: str) -> None:
    modules: dict[str, Any] = sys.modules
    if left_out in modules or any(name in modules for name in names):
        return
    modules[left_out] = None  # the import system's own way to say that a module cannot be imported
    try:
        for name in names:
            import_module(name)
    finally:
        del modules[left_out]


def _exists(name: str) -> bool:
    try:
        import_module(name)
    except ImportError:
        return False
    return True
