"""The programs load asyncio and hashlib without OpenSSL, which stays importable for others."""

from __future__ import annotations

import subprocess
import sys

import pytest

LOADED = "import sys; from link.runtime import without_openssl; without_openssl.load(); "
AFTERWARDS = (
    "import link.signing.signature; assert 'asyncio' in sys.modules; assert not {'ssl', '_hashlib'} & set(sys.modules);"
)
USABLE = "import ssl, asyncio; ssl.create_default_context(); asyncio.run(asyncio.sleep(0)); without_openssl.load()"
STATION = "import sys, groundstation.host.station_process; "
HASHES = (
    "import hashlib, hmac, _hashlib; text = b'a frame' * 40; "
    "assert hashlib.sha256(text).digest() == _hashlib.openssl_sha256(text).digest(); "
    "assert hmac.digest(b'key', text, 'sha256') == _hashlib.hmac_digest(b'key', text, 'sha256')"
)
PASSPHRASE = (
    "from link.signing.keys import PassphraseKind, key_from_passphrase; "
    "assert len(key_from_passphrase('text', PassphraseKind.PBKDF2)) == 32; "
    "assert '_hashlib' in sys.modules"  # Python 3.12 has no other implementation
)


@pytest.mark.parametrize(
    "code",
    [
        LOADED + AFTERWARDS + USABLE,
        LOADED + AFTERWARDS + HASHES,
        LOADED + AFTERWARDS + PASSPHRASE,
        STATION + AFTERWARDS,
    ],
    ids=["asyncio", "hashlib", "passphrase", "station"],
)
def test_openssl_is_not_loaded(code: str) -> None:
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.stderr == ""
