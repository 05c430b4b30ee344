"""Type the install lines of docs/install.md with the wheels of dist/wheels, without a network.

Each program then says how an extra is added, and that line is typed, too. Needs pipx, uv, and root for a network
namespace.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.docs_blocks.markdown import find_blocks

ROOT = Path(__file__).resolve().parents[2]
WHEELS = ROOT / "dist/wheels"
FOLDERS = ("mavhelm/bin", ".local/bin")
"""Where programs are after the installation, below the home folder."""
TOOLS = ("pipx", "uv", "uvx", "unshare")
UPDATES = {"python3": "install --upgrade", "pipx": "install --force", "uv": "install --reinstall"}
"""First word of a line -> what stands there for `install` to update, as in the table of the page."""
REMOVALS = {"python3": "cd && rm -rf mavhelm", "pipx": "pipx uninstall mavhelm", "uv": "uv tool uninstall mavhelm"}
"""First word of a line -> the line of docs/faq.md that removes the program."""


class LineError(Exception):
    """A line did not do what the page says; the text has its output."""


def main() -> int:
    """Return 0 if every line works."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing or not WHEELS.is_dir():
        print(f"installs: missing: {', '.join(missing) or 'dist/wheels (make wheels)'}", file=sys.stderr)
        return 2
    for line in install_lines((ROOT / "docs/install.md").read_text()):
        with tempfile.TemporaryDirectory(prefix="mavhelm-installs-") as folder:
            try:
                try_line(line, Path(folder))
            except LineError as failed:
                print(f"{line}: {failed}", file=sys.stderr)
                return 1
        print(f"works: {line}", flush=True)
    return 0


def install_lines(page: str) -> list[str]:
    """Return the lines of the page's block that begins with a virtual environment."""
    [block] = [block for block in find_blocks(page) if block.text.startswith("python3 -m venv ~/mavhelm")]
    return block.text.splitlines()


def try_line(line: str, home: Path) -> None:
    """Install in an empty home folder, run the program, add the extra `web` as it says, update and uninstall."""
    (home / "wheels").symlink_to(WHEELS)
    if line.startswith("uvx"):
        type_line(line.replace("--sitl", "--version"), home)
        hint = asked_extra(line.replace("--sitl", "serve --web"), home)
        if hint != "uvx 'mavhelm[web]'":
            raise LineError(f"it names {hint}")
        return
    type_line(line, home)
    type_line("mavhelm --version && groundstation --version && vehicle --version", home)
    type_line(asked_extra("mavhelm serve --web", home), home)
    type_line('$(head -n 1 "$(command -v mavhelm)" | cut -c 3-) -c "import textual_serve"', home)
    way = line.split()[0]
    type_line(line.replace("install", UPDATES[way], 1), home)
    type_line("mavhelm --version", home)
    type_line(REMOVALS[way], home)
    type_line("mavhelm --version", home, code=127)


def asked_extra(command: str, home: Path) -> str:
    """Return the line that a program prints where the extra `web` is missing."""
    refused = type_line(command, home, code=2)
    _, found, hint = refused.strip().partition("which is not installed: ")
    if not found:
        raise LineError(f"{command} names no command: {refused}")
    return hint.splitlines()[0]


def type_line(line: str, home: Path, code: int = 0) -> str:
    """Type a line in a shell without a network; return its output. Raises LineError for another exit code."""
    places = [str(home / folder) for folder in FOLDERS]
    environment = {
        "HOME": str(home),
        "PATH": os.pathsep.join((*places, os.environ["PATH"])),
        "LANG": "C.UTF-8",
        # for pip, whose line names no folder: it has no memory of where a package came from
        "PIP_NO_INDEX": "1",
        "PIP_FIND_LINKS": str(WHEELS),
    }
    command = ["unshare", "-n", "sh", "-c", line]
    done = subprocess.run(
        command, cwd=home, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
    )
    if done.returncode != code:
        raise LineError(f"{line}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


if __name__ == "__main__":
    sys.exit(main())
