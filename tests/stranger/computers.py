"""The computers on which README is read: this one with an empty environment, or a bare Debian in a folder."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from tests.docs_blocks.terminal import Terminal

ADDRESS = "https://YOUR-COPY-OF-THIS-REPOSITORY"
"""What README writes for the address of a repository; git is told that it is this checkout."""
PATIENCE = 3600.0
"""s for a line: packages are fetched and installed, and the tests run."""
USER = "stranger"
SEARCH_PATH = "/usr/local/bin:/usr/bin:/bin"
ROOTS_PATH = "/usr/local/sbin:/usr/sbin:/sbin"
TRUST = ("/etc/resolv.conf", "/etc/pip.conf", "/usr/local/share/ca-certificates")
"""What a bare Debian gets of this machine, where it is there: how networks and the package index are reached."""
MACHINERY = ("proc", "sys", "dev", "tmp")


class Computer(Protocol):
    """A place in which somebody reads README."""

    name: str
    bare: bool
    """Packages of the system are installed as README says."""

    def open_terminal(self, root: bool = False) -> Terminal:
        """Return a new terminal in an empty folder, with an environment of HOME, PATH and TERM."""


def namespaces() -> list[str]:
    """Return a command that runs another one with mounts and processes of its own, which end with it.

    Its mounts are seen nowhere else, so that nobody who removes the folder of a BareDebian reaches /dev or /sys.
    """
    return ["unshare", "--mount", "--propagation=private", "--pid", "--fork", "--kill-child", "--mount-proc"]


class ThisComputer:
    """A home folder of its own on this machine. Packages of the system are those that are installed."""

    bare = False

    def __init__(self, folder: Path, source: Path, settings: Mapping[str, str]) -> None:
        self.name = "this computer"
        self._settings = settings
        self._home = folder / "home"
        self._home.mkdir()
        (self._home / ".gitconfig").write_text(_git_config(source))

    def open_terminal(self, root: bool = False) -> Terminal:
        """Return a new terminal."""
        environment = {"HOME": str(self._home), "PATH": SEARCH_PATH, **self._settings}
        return Terminal(self._home, environment, patience=PATIENCE)


class BareDebian:
    """A Debian with what `debootstrap --variant=minbase` installs. It is left as it is; a copy of it is used."""

    bare = True

    def __init__(self, folder: Path, source: Path, settings: Mapping[str, str], suite: str, cache: Path) -> None:
        self.name = f"a bare Debian {suite}"
        self._settings = settings
        self._root = folder / "root"
        subprocess.run(["cp", "-a", "--reflink=auto", str(_bootstrap(suite, cache)), str(self._root)], check=True)
        for each in map(Path, TRUST):
            if each.exists():
                _copy(each, self._root / each.relative_to("/"))
        subprocess.run(["git", "clone", "-q", "--bare", str(source), str(self._root / "srv/mavhelm.git")], check=True)
        for name in MACHINERY[:3]:
            subprocess.run(["mount", "--rbind", f"/{name}", str(self._root / name)], check=True)
        subprocess.run(["mount", "-t", "tmpfs", "tmp", str(self._root / "tmp")], check=True)
        self._in_root("useradd", "--create-home", "--shell", "/bin/bash", USER)
        (self._root / "home" / USER / ".gitconfig").write_text(_git_config(Path("/srv/mavhelm.git")))

    def open_terminal(self, root: bool = False) -> Terminal:
        """Return a new terminal of USER, or of root."""
        user, home = ("root", "/root") if root else (USER, f"/home/{USER}")
        environment = {"HOME": home, "PATH": f"{ROOTS_PATH}:{SEARCH_PATH}" if root else SEARCH_PATH, **self._settings}
        within = ("/usr/sbin/chroot", f"--userspec={user}:{user}", str(self._root), "/usr/bin/env", "--chdir", home)
        return Terminal(Path("/"), environment, within=within, patience=PATIENCE)

    def _in_root(self, *command: str) -> None:
        environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin"}
        subprocess.run(["/usr/sbin/chroot", str(self._root), *command], env=environment, check=True)


def _bootstrap(suite: str, cache: Path) -> Path:
    """Return the folder of a bare Debian, made if it is not there yet."""
    kept = cache / suite
    if not kept.exists():
        cache.mkdir(parents=True, exist_ok=True)
        partly = cache / f"{suite}.{os.getpid()}"
        subprocess.run(["debootstrap", "--variant=minbase", suite, str(partly)], check=True)
        partly.rename(kept)
    return kept


def _copy(source: Path, target: Path) -> None:
    if source.is_dir():
        shutil.copytree(source, target, dirs_exist_ok=True)
    else:
        target.unlink(missing_ok=True)  # a link of the bare system would lead out of it
        target.write_bytes(source.read_bytes())


def _git_config(source: Path) -> str:
    """Return the settings with which git finds `source` at ADDRESS, whoever owns it."""
    return f'[url "{source}"]\n\tinsteadOf = {ADDRESS}\n[safe]\n\tdirectory = *\n'
