"""The command that installs the packages of an extra for the running Python."""

from __future__ import annotations

import importlib.util
import shlex
import sys


def install_command(extra: str) -> str:
    """Return the line for a shell that adds the extra `[extra]` of mavhelm to the Python that runs.

    It names that Python, because the `pip` of the search path is often the system's: that one refuses on Debian 12 and
    later ("externally-managed-environment"), and would install for another Python. An environment that uv has made has
    no pip of its own.
    """
    python = shlex.quote(sys.executable)
    if importlib.util.find_spec("pip") is None:
        return f"uv pip install --python {python} 'mavhelm[{extra}]'"
    return f"{python} -m pip install 'mavhelm[{extra}]'"
