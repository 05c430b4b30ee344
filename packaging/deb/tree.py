"""Lays out the files of the package in a folder that dpkg-deb packs."""

from __future__ import annotations

import configparser
import gzip
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from deb import control
from deb.target import DebTarget
from deb.wheels import packages_of, read_info, read_metadata, unpack

HERE = Path(__file__).parent
PRIVATE = ("bridge",)
"""Programs with a name that others have, too: iproute2 has a `bridge`. They are not on the path."""
GROUPS = ("dialout", "gpio", "i2c", "video")
"""Groups of rover.service; those that Debian lacks are made at the installation (files/sysusers.conf)."""
PLACED = {
    "files/60-mavhelm.rules": "usr/lib/udev/rules.d/60-mavhelm.rules",
    "files/sysusers.conf": "usr/lib/sysusers.d/mavhelm.conf",
    "files/lintian-overrides": "usr/share/lintian/overrides/mavhelm",
    "../mavhelm.desktop": "usr/share/applications/mavhelm.desktop",
}
"""File beside this one -> its place in the package."""


@dataclass(frozen=True, slots=True)
class Build:
    """What a package is made of."""

    target: DebTarget
    wheel: Path
    """Of mavhelm."""
    bundled: Sequence[Path]
    """Wheels of all that it needs."""
    revision: int
    time: int
    """s since 1970 of all files: that of the commit."""

    @property
    def version(self) -> str:
        """Return the version of the package."""
        return self.target.version(str(read_metadata(self.wheel)["Version"]), self.revision)


def lay_out(build: Build, root: Path, project: Path) -> None:
    """Write all files below `root`, also those of DEBIAN. `project`: the checkout, for its CHANGELOG."""
    environment = root / control.FOLDER[1:]
    _lay_out_environment(build, environment)
    _link_programs(environment, root / "usr/bin", read_info(build.wheel, "entry_points.txt"))
    for source, place in PLACED.items():
        _write(root / place, (HERE / source).read_text())
    _write(root / control.CONFIG[1:], control.config(_print_with(environment, CONFIG_TEXT, build)))
    unit = control.unit(_print_with(environment, UNIT_TEXT, build))
    _write(root / "usr/lib/systemd/system" / control.UNIT, unit)
    _write_documents(build, root, project)
    _write_manuals(build, environment, root / "usr/share/man/man1")
    _write_control(build, root)
    set_times(root, build.time)


def pack(root: Path, folder: Path, build: Build) -> Path:
    """Return the package, packed from the laid out files. Its bytes depend on these alone."""
    package = folder / f"{control.PACKAGE}_{build.version}_{build.target.architecture}.deb"
    environment = {**os.environ, "SOURCE_DATE_EPOCH": str(build.time)}
    command = ["dpkg-deb", "--root-owner-group", "-Zxz", "-z4", "--threads-max=1", "--build", str(root), str(package)]
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
    return package


def _lay_out_environment(build: Build, environment: Path) -> None:
    """Make what `python3 -m venv` makes, for the Python of the target, which also sees Debian's own packages."""
    site = environment / "lib" / f"python{build.target.python}" / "site-packages"
    for wheel in (build.wheel, *build.bundled):
        unpack(wheel, site)
    for path in site.rglob("*"):
        path.chmod(0o755 if path.is_dir() else 0o644)
    _write(environment / "pyvenv.cfg", "home = /usr/bin\ninclude-system-site-packages = true\n")
    (environment / "bin").mkdir()
    (environment / "bin/python3").symlink_to("../../../bin/python3")
    for name, script in launchers(read_info(build.wheel, "entry_points.txt")).items():
        _write(environment / "bin" / name, script, 0o755)


def launchers(entry_points: str) -> dict[str, str]:
    """Return the programs of a wheel, as pip writes them, by name."""
    parser = configparser.ConfigParser(delimiters="=")
    parser.read_string(entry_points)
    scripts = {}
    for name, place in parser["console_scripts"].items():
        module, _, function = place.partition(":")
        scripts[name] = (
            f"#!{control.FOLDER}/bin/python3 -P\n"
            f"import sys\n\nfrom {module} import {function}\n\nsys.exit({function}())\n"
        )
    return scripts


def _link_programs(environment: Path, folder: Path, entry_points: str) -> None:
    folder.mkdir(parents=True)
    for name in launchers(entry_points).keys() - set(PRIVATE):
        (folder / name).symlink_to(f"../lib/{environment.name}/bin/{name}")


CONFIG_TEXT = "from vehicle.config.template import build_template; print(build_template(), end='')"
UNIT_TEXT = f"""
from pathlib import Path
from vehicle.cli.systemd_unit import UnitOptions, build_unit
print(build_unit(UnitOptions(
    Path({control.CONFIG!r}), Path({control.FOLDER!r}) / "bin/python3", {GROUPS!r}, {control.USER!r})), end="")
"""


def _print_with(environment: Path, code: str, build: Build) -> str:
    """Return what our own packages print: the modules of the package, with the libraries of the Python that runs."""
    command = [sys.executable, "-P", "-c", code]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=_ours(environment, build)).stdout


def _ours(environment: Path, build: Build) -> dict[str, str]:
    """Return an environment in which our modules are those of the package.

    Other modules of the package may be for another Python and processor.
    """
    site = environment / "lib" / f"python{build.target.python}" / "site-packages"
    ours = environment.parent.parent.parent.with_name("ours")
    if not ours.exists():
        ours.mkdir()
        for name in packages_of(build.wheel):
            (ours / name).symlink_to(site / name)
    path = os.pathsep.join((str(ours), str(HERE.parent)))
    return {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}


def _write_documents(build: Build, root: Path, project: Path) -> None:
    folder = root / "usr/share/doc" / control.PACKAGE
    bundled = [read_metadata(wheel) for wheel in build.bundled]
    _write(folder / "copyright", control.copyright_file(bundled))
    _compress(folder / "changelog.gz", (project / "CHANGELOG.md").read_text())
    changes = control.changelog(build.version, build.target.suite, build.time)
    _compress(folder / "changelog.Debian.gz", changes)


def _write_manuals(build: Build, environment: Path, folder: Path) -> None:
    command = [sys.executable, "-P", "-m", "manpages", str(folder)]
    times = {**_ours(environment, build), "SOURCE_DATE_EPOCH": str(build.time)}
    subprocess.run(command, check=True, env=times)
    for page in sorted(folder.iterdir()):
        if page.read_text().startswith(".so "):
            shown = page.read_text().split("/")[-1].strip()
            page.with_name(f"{page.name}.gz").symlink_to(f"{shown}.gz")
        else:
            _compress(page.with_name(f"{page.name}.gz"), page.read_text())
        page.unlink()


def _write_control(build: Build, root: Path) -> None:
    size = sum(path.lstat().st_size for path in root.rglob("*") if not path.is_dir()) // 1024
    folder = root / "DEBIAN"
    _write(folder / "control", control.control(build.target, build.version, size))
    _write(folder / "conffiles", control.conffiles())
    for name, script in control.scripts().items():
        _write(folder / name, script, 0o755)
    sums = subprocess.run(
        "find usr -type f -print0 | sort -z | xargs -0 md5sum", shell=True, cwd=root, check=True, capture_output=True
    )
    (folder / "md5sums").write_bytes(sums.stdout)


def _write(file: Path, text: str, mode: int = 0o644) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
    file.chmod(mode)


def _compress(file: Path, text: str) -> None:
    """Write a text without the time of now."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(gzip.compress(text.encode(), 9, mtime=0))
    file.chmod(0o644)


def set_times(root: Path, seconds: int) -> None:
    """Give all files the same time and all folders the same rights."""
    for path in (root, *root.rglob("*")):
        if path.is_dir() and not path.is_symlink():
            path.chmod(0o755)
        os.utime(path, (seconds, seconds), follow_symlinks=False)
