"""Checks that dialects/rover.py was generated from the definitions beside it.

Imports no other module of the project: dialects/build.py runs this file by its path, before the project is installed.
"""

from __future__ import annotations

import hashlib
import shlex
import sys
from importlib.metadata import version
from pathlib import Path

HERE = Path(__file__).resolve().parent
INPUTS = ("rover.xml", "additions.xml", "build.py")
REMEDY = f"run {shlex.quote(sys.executable)} -m pip install -e {shlex.quote(str(HERE.parent))} to generate it"
"""Names the running Python: the `pip` of the search path may be another one's."""


def line(folder: Path = HERE) -> str:
    """Return the last line of a generated module: a digest of its inputs and of pymavlink's version."""
    digest = hashlib.sha256(version("pymavlink").encode())
    for name in INPUTS:
        digest.update(hashlib.sha256((folder / name).read_bytes()).digest())
    return f"# made from {digest.hexdigest()}"


def fault(folder: Path = HERE) -> str | None:
    """Return why the module in `folder` cannot be used and the remedy, in one line, or None."""
    try:
        code = (folder / "rover.py").read_bytes()
    except FileNotFoundError:
        return f"dialects/rover.py is missing: {REMEDY}"
    if not code.endswith(f"\n{line(folder)}\n".encode()):
        return f"dialects/rover.py is older than its definitions: {REMEDY}"
    return None
