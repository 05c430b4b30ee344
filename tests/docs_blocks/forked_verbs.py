"""Verbs of a page with very many are forked: a start takes 0.3 s of CPU, and docs/commands.md has a hundred.

Before the real `mavhelm` in PATH comes a client of tests/forked.py, which runs the same `main` with the same words,
environment, folder and streams, passes signals on, and ends with the same exit code. All else it leaves to the real
one, which other pages and the lines of README.md run for each verb, too.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from groundstation.verbs.table import VERBS
from tests.forked import Forks

MANY = 50
"""Commands of `mavhelm` on a page from which on its verbs are forked."""
REAL = frozenset({"sign"})
"""Verbs that ask at /dev/tty, which a forked program has not."""

CLIENT = """#!{python} -IS
import os, sys, _signal, _socket
from _json import encode_basestring_ascii as quoted

words = sys.argv[1:]
if not words or words[0] not in {verbs}:
    os.execv({real!r}, [{real!r}, *words])
connection = _socket.socket(_socket.AF_UNIX, _socket.SOCK_SEQPACKET)
connection.connect({address!r})
environment = ",".join(f"{{quoted(key)}}:{{quoted(value)}}" for key, value in os.environ.items())
request = f'[[{{",".join(map(quoted, ["link.program", *words]))}}],{{quoted(os.getcwd())}},{{{{{{environment}}}}}}]'
streams = b"".join(each.to_bytes(4, sys.byteorder) for each in (0, 1, 2))
connection.sendmsg([request.encode()], [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, streams)])
pid = int(connection.recv(64))
for number in (_signal.SIGINT, _signal.SIGTERM, _signal.SIGHUP):
    _signal.signal(number, lambda number, _: os.kill(pid, number))
code = int(connection.recv(64))
sys.exit(code if code >= 0 else 128 - code)
"""
"""Without the modules of Python's library, which would take as long to import as a forked program to start."""


@contextmanager
def forked_verbs(page: Path, programs: Path) -> Iterator[None]:
    """Put the client into a folder of PATH while a page with MANY commands is typed."""
    if len(re.findall(r"^(?:until )?mavhelm\b", page.read_text(), re.MULTILINE)) < MANY:
        yield
        return
    forks = Forks()
    try:
        real = str(Path(sys.executable).with_name("mavhelm"))
        text = CLIENT.format(python=sys.executable, verbs={*VERBS} - REAL, real=real, address=forks.address)
        (programs / "mavhelm").write_text(text)
        (programs / "mavhelm").chmod(0o755)
        yield
    finally:
        forks.close()
