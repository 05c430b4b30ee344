"""Is dialects/rover.py made from the definitions that are here? A checkout keeps it, and definitions change under it.

It imports nothing of ours: dialects/build.py runs it by its path, where the project is not installed yet.
"""

from __future__ import annotations

import hashlib
from importlib.metadata import version
from pathlib import Path

HERE = Path(__file__).resolve().parent
INPUTS = ("rover.xml", "additions.xml", "build.py")
REMEDY = "pip install -e . makes it anew"


def line(folder: Path = HERE) -> str:
    """The last line of a generated module: a digest of what it is made from in `folder`, and of pymavlink's version."""
    digest = hashlib.sha256(version("pymavlink").encode())
    for name in INPUTS:
        digest.update(hashlib.sha256((folder / name).read_bytes()).digest())
    return f"# made from {digest.hexdigest()}"


def fault(folder: Path = HERE) -> str | None:
    """What is wrong with the module in `folder`, and what to do, in one line."""
    try:
        code = (folder / "rover.py").read_bytes()
    except FileNotFoundError:
        return f"dialects/rover.py is missing: {REMEDY}"
    if not code.endswith(f"\n{line(folder)}\n".encode()):
        return f"dialects/rover.py is older than its definitions: {REMEDY}"
    return None
