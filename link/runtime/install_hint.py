"""The command that installs the packages of an extra where the program is installed."""

from __future__ import annotations

import importlib.util
import json
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

NAME = "mavhelm"
SYSTEM_FOLDER = Path("/usr/lib/mavhelm")
"""Where the Debian package keeps the program (packaging/deb)."""
SYSTEM_PACKAGES = {"pi": "python3-lgpio", "bags": "python3-numpy", "ros": "python3-numpy"}
"""What the Debian package leaves to Debian: it contains the packages of all other extras."""
UV_CACHE = "archive-v0"
"""Folder of uv's cache with the environments of uvx, which last for one run."""


def install_command(extra: str) -> str:
    """Return the line for a shell that adds the extra `[extra]` of mavhelm to this installation.

    A tool that keeps a program in an environment of its own is named itself: what pip added there, it would remove.
    """
    prefix = Path(sys.prefix)
    for is_kind, line in _KINDS:
        if is_kind(prefix):
            return line(prefix, extra)
    return _venv(prefix, extra)


def _system(prefix: Path, extra: str) -> str:
    package = SYSTEM_PACKAGES.get(extra)
    return f"sudo apt install {package}" if package else f"sudo apt install --reinstall {NAME}"


def _uv_tool(prefix: Path, extra: str) -> str:
    """Return `uv tool install` with all that its receipt has, because uv replaces the tool."""
    import tomllib

    receipt = _read(prefix / "uv-receipt.toml", tomllib.loads)
    options, rows = receipt.get("options", {}), receipt.get("requirements", [])
    main = next((row for row in rows if row.get("name") == NAME), {"name": NAME})
    others = [word for row in rows if row is not main for word in ("--with", _requirement(row))]
    extras = sorted({*main.get("extras", ()), extra})
    python = ["--python", receipt["python"]] if receipt.get("python") else []
    return shlex.join(
        ["uv", "tool", "install", *_package_source(options), *python, *others, _requirement({**main, "extras": extras})]
    )


def _package_source(options: dict[str, Any]) -> Iterator[str]:
    """Yield uv's options for a folder of wheels, with which the program was installed."""
    if options.get("no-index"):
        yield "--no-index"
    for folder in options.get("find-links", ()):
        yield from ("--find-links", folder)


def _requirement(row: dict[str, Any]) -> str:
    """Return a row of uv's receipt as a requirement: name[extras], with its version or address."""
    extras = f"[{','.join(row['extras'])}]" if row.get("extras") else ""
    local = row.get("path") or row.get("directory") or row.get("editable")
    git = "git+" + row["git"].replace("?rev=", "@") if "git" in row else None
    address = git or row.get("url") or (Path(local).as_uri() if local else None)
    return f"{row['name']}{extras}" + (f" @ {address}" if address else row.get("specifier", ""))


def _uvx(prefix: Path, extra: str) -> str:
    return f"uvx '{NAME}[{extra}]'"


def _pipx(prefix: Path, extra: str) -> str:
    """Return `pipx inject` for an installed program, `pipx run` for one in pipx's cache."""
    if prefix.parent.name != "venvs":
        return f"pipx run '{NAME}[{extra}]'"
    main = _read(prefix / "pipx_metadata.json", json.loads).get("main_package", {})
    source = f" --pip-args={shlex.quote(shlex.join(main['pip_args']))}" if main.get("pip_args") else ""
    return f"pipx inject{source} {shlex.quote(prefix.name)} '{NAME}[{extra}]'"


def _venv(prefix: Path, extra: str) -> str:
    """Return pip of the Python that runs.

    The `pip` of the search path is often the system's: that one refuses on Debian 12 and later
    ("externally-managed-environment"), and would install for another Python. An environment that uv has made has no pip
    of its own.
    """
    python = shlex.quote(sys.executable)
    if importlib.util.find_spec("pip") is None:
        return f"uv pip install --python {python} '{NAME}[{extra}]'"
    return f"{python} -m pip install '{NAME}[{extra}]'"


def _read(file: Path, parse: Callable[[str], Any]) -> dict[str, Any]:
    """Return the contents of a tool's own file, of uv the table `tool`; empty if it cannot be read."""
    try:
        contents: dict[str, Any] = parse(file.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    table: dict[str, Any] = contents.get("tool", contents)
    return table


_KINDS: tuple[tuple[Callable[[Path], bool], Callable[[Path, str], str]], ...] = (
    (lambda prefix: prefix == SYSTEM_FOLDER, _system),
    (lambda prefix: (prefix / "uv-receipt.toml").is_file(), _uv_tool),
    (lambda prefix: UV_CACHE in prefix.parts, _uvx),
    (lambda prefix: (prefix / "pipx_metadata.json").is_file(), _pipx),
)
"""How to recognise an installation by its folder, and its command; any other is a virtual environment."""
