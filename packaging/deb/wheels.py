"""Finds the wheels of mavhelm and of what it needs on another machine, fetches and unpacks them."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Callable, Collection, Iterable, Mapping
from email.message import Message
from email.parser import Parser
from fnmatch import fnmatch
from pathlib import Path, PurePosixPath

from packaging.requirements import Requirement
from packaging.utils import NormalizedName, canonicalize_name, parse_wheel_filename

from deb.target import DebTarget

EXTRAS = ("all", "pi")
LEFT_OUT = {
    "numpy": "Debian's python3-numpy is used",
    "lgpio": "Debian's python3-lgpio is used; there is no wheel for Python 3.13",
    "lxml": "only for the code generator of pymavlink, which is left out",
}
"""Package -> why it is not in the Debian package."""
PARTS: Mapping[str, tuple[str, ...]] = {
    "pymavlink": ("pymavlink/__init__.py", "pymavlink/dialects/*.xml", "pymavlink-*.dist-info/*"),
}
"""Package -> the files that are used. The modules of pymavlink's dialects alone are 43 MB, to be compiled on a Pi."""
UNUSED = ("sdl2/examples/*", "sdl2/test/*", "apsw/sqlite_extra_binaries/*", "textual_serve/templates/*")
"""Files that nothing imports: tests, examples, programs, and a page that would fetch a font from elsewhere."""

Metadata = Callable[[NormalizedName], Message]
"""Name of a package, normalized -> its METADATA."""


class MissingWheelError(Exception):
    """There is no wheel of a package for the target; the text is one line."""


def needed_by(
    message: Message, extras: Collection[str], environment: Mapping[str, str]
) -> dict[NormalizedName, frozenset[str]]:
    """Return the packages that one needs with these extras, each with its own extras, but for LEFT_OUT."""
    needs: dict[NormalizedName, frozenset[str]] = {}
    for line in message.get_all("Requires-Dist", []):
        requirement, name = Requirement(line), canonicalize_name(Requirement(line).name)
        marker = requirement.marker
        if marker and not any(marker.evaluate({**environment, "extra": extra}) for extra in ("", *extras)):
            continue
        if name not in LEFT_OUT:
            needs[name] = needs.get(name, frozenset()) | requirement.extras
    return needs


def collect(
    main: Message, environment: Mapping[str, str], fetch: Callable[[Collection[NormalizedName]], Metadata]
) -> list[NormalizedName]:
    """Return all packages that the main one needs, sorted. `fetch` gets packages that are new, once each."""
    name = canonicalize_name(main["Name"])
    extras: dict[NormalizedName, frozenset[str]] = {}
    known: dict[NormalizedName, Message] = {name: main}
    later = {name: frozenset(EXTRAS)}
    while later:
        missing = later.keys() - known.keys()
        if missing:
            read = fetch(sorted(missing))
            known |= {each: read(each) for each in missing}
        found: dict[NormalizedName, frozenset[str]] = {}
        for each, wanted in later.items():
            extras[each] = extras.get(each, frozenset()) | wanted
            for need, its_extras in needed_by(known[each], extras[each], environment).items():
                found[need] = found.get(need, frozenset()) | its_extras
        later = {each: wanted for each, wanted in found.items() if each not in extras or not wanted <= extras[each]}
    return sorted(extras.keys() - {name})


def download(names: Collection[str], target: DebTarget, folder: Path, constraints: Path) -> None:
    """Fetch the wheels of packages in the versions of the file. Raises MissingWheelError."""
    platforms = [word for each in target.platforms for word in ("--platform", each)]
    command = [
        sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary", ":all:", *platforms,
        "--python-version", target.python, "--implementation", "cp", "-c", str(constraints), "-d", str(folder), *names,
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        reasons = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
        raise MissingWheelError(f"pip for {target.architecture}: {(reasons or [done.stderr.strip()])[-1]}")


def gather(wheel: Path, target: DebTarget, folder: Path, constraints: Path) -> list[Path]:
    """Return the wheels of all that mavhelm's wheel needs, fetched into the folder. Raises MissingWheelError."""

    def fetch(names: Collection[NormalizedName]) -> Metadata:
        new = set(names) - wheels_in(folder).keys()
        if new:
            download(sorted(new), target, folder, constraints)
        there = wheels_in(folder)
        return lambda name: read_metadata(there[name])

    needed = collect(read_metadata(wheel), target.environment, fetch)
    there = wheels_in(folder)
    return [there[name] for name in needed]


def wheels_in(folder: Path) -> dict[NormalizedName, Path]:
    """Return package -> its wheel."""
    return {parse_wheel_filename(path.name)[0]: path for path in sorted(folder.glob("*.whl"))}


def read_metadata(wheel: Path) -> Message:
    """Return METADATA of a wheel."""
    return Parser().parsestr(read_info(wheel, "METADATA"))


def read_info(wheel: Path, name: str) -> str:
    """Return a file of a wheel's dist-info folder; "" if it is missing."""
    with zipfile.ZipFile(wheel) as archive:
        [*found] = [each for each in archive.namelist() if fnmatch(each, f"*.dist-info/{name}")]
        return archive.read(found[0]).decode() if found else ""


def packages_of(wheel: Path) -> list[str]:
    """Return the top folders of a wheel: its packages, and its metadata."""
    with zipfile.ZipFile(wheel) as archive:
        return sorted({name.split("/")[0] for name in archive.namelist() if "/" in name})


def unpack(wheel: Path, site: Path) -> None:
    """Unpack what is imported from a wheel, and its metadata with the licences."""
    name = parse_wheel_filename(wheel.name)[0]
    with zipfile.ZipFile(wheel) as archive:
        for each in kept_files(name, archive.namelist()):
            archive.extract(each, site)


def kept_files(name: str, files: Iterable[str]) -> list[str]:
    """Return the files of a wheel that the package has: no byte code, no scripts, no list for pip to remove them."""
    patterns = PARTS.get(name, ("*",))
    return [
        file
        for file in files
        if any(fnmatch(file, pattern) for pattern in patterns)
        and not any(fnmatch(file, pattern) for pattern in UNUSED)
        and "__pycache__" not in PurePosixPath(file).parts
        and ".data" not in PurePosixPath(file).parts[0]
        and not file.endswith((".dist-info/RECORD", ".gitignore", "/"))
    ]
