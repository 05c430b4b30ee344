"""Run the core part of the test suite on an emulated aarch64: Debian's own Python for arm64 in QEMU's user mode.

QEMU translates the instructions of one process and passes its system calls to this machine's kernel, so this is about
the interpreter and the wheels of that machine, not about its speed. What starts processes or needs a terminal is left
out: the kernel would start this machine's Python.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

from tests.aarch64.root import ARCHITECTURE, MissingError, Root, prepare

TREE = Path(__file__).resolve().parents[2]
CACHE = Path("/var/tmp/mavhelm-aarch64")
CORE = ("tests/vehicle/drive", "tests/vehicle/safety", "tests/link/protocol", "tests/dialects/test_axes.py")
"""Without I/O: what turns bytes into motor outputs, and what stops them."""
PYTEST = (
    "-m", "pytest", "-p", "no:cacheprovider", "-q", "--color=no", "--tb=short", "--timeout=1200",
    "-m", "not slow and not e2e",
)  # fmt: skip
NICENESS = 19
FACTS = "import platform; print(platform.machine(), platform.python_version(), platform.libc_ver())"


def main(words: list[str]) -> int:
    """Run the tests; return pytest's exit code, 2 if there is no emulation."""
    parser = argparse.ArgumentParser(prog="python -m tests.aarch64", description=__doc__.partition("\n")[0])
    parser.add_argument("--folder", type=Path, default=CACHE, help="keeps the emulated system (default: %(default)s)")
    parser.add_argument("tests", nargs="*", default=CORE, help="arguments for pytest (default: the core)")
    options = parser.parse_args(words)
    try:
        root = prepare(options.folder, TREE / "constraints.txt")
    except MissingError as error:
        print(f"aarch64: {error}", file=sys.stderr)
        return 2
    machine = _read(root, FACTS)
    if not machine.startswith(ARCHITECTURE):
        print(f"aarch64: this is no {ARCHITECTURE}: {machine}", file=sys.stderr)
        return 2
    print(f"aarch64: {machine}", flush=True)
    begun = time.monotonic()
    code = subprocess.run([*root.python, *PYTEST, *options.tests], cwd=TREE, env=_environment(root), check=False)
    print(f"aarch64: {time.monotonic() - begun:.0f} s")
    return code.returncode


def _read(root: Root, code: str) -> str:
    command = [*root.python, "-c", code]
    done = subprocess.run(command, cwd=TREE, env=_environment(root), capture_output=True, text=True, check=False)
    return (done.stdout or done.stderr).strip()


def _environment(root: Root) -> dict[str, str]:
    os.nice(max(0, NICENESS - os.nice(0)))
    path = os.pathsep.join((str(TREE), str(root.site)))
    return {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONNOUSERSITE": "1"}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
