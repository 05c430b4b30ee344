"""The programs load asyncio without OpenSSL, which stays importable for others."""

from __future__ import annotations

import subprocess
import sys

import pytest

LOADED = "import sys; from link.runtime import asyncio_without_ssl; asyncio_without_ssl.load(); "
AFTERWARDS = "assert 'asyncio' in sys.modules and 'ssl' not in sys.modules; "
USABLE = "import ssl, asyncio; ssl.create_default_context(); asyncio.run(asyncio.sleep(0)); asyncio_without_ssl.load()"
STATION = "import sys, groundstation.host.station_process; "


@pytest.mark.parametrize("code", [LOADED + AFTERWARDS + USABLE, STATION + AFTERWARDS], ids=["asyncio", "station"])
def test_asyncio_is_loaded_without_openssl(code: str) -> None:
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.stderr == ""
