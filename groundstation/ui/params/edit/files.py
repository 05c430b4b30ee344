"""Parameter files on this machine: what to save is typed with the name of the file."""

from __future__ import annotations

from pathlib import Path

import msgspec

MAX_SIZE = 200_000
"""Bytes of a file that is compared; QGroundControl's form of 1235 parameters has 60 kB."""
FORMS = ("mavproxy", "qgc", "mp")
PARTS = ("all", "changed", "group")


class SaveChoice(msgspec.Struct, frozen=True):
    """What to save where."""

    path: Path
    part: str = "all"
    form: str = "mavproxy"


def parse_save(text: str, folder: Path) -> SaveChoice | str:
    """Return what is to be saved: "FILE", then "all", "changed" or "group", then "mavproxy", "qgc" or "mp".

    Without a form, .params is QGroundControl's. Returns what is wrong with the text.
    """
    name, part, form = text.strip(), "", ""
    while " " in name and (word := name.rpartition(" ")[2]) in (*PARTS, *FORMS):
        part, form = (word, form) if word in PARTS else (part, word)
        name = name.rpartition(" ")[0].rstrip()
    if not name:
        return "no file is named"
    path = folder / Path(name).expanduser()
    return SaveChoice(path, part or "all", form or ("qgc" if path.suffix == ".params" else "mavproxy"))


def read_file(text: str, folder: Path) -> tuple[str, str] | str:
    """Return the name and the text of a file, or why it cannot be read."""
    path = folder / Path(text.strip()).expanduser()
    try:
        if not path.is_file():
            return f"{path}: there is no such file"
        with path.open("rb") as file:
            data = file.read(MAX_SIZE + 1)
    except OSError as error:
        return f"{path}: {error.strerror}"
    if len(data) > MAX_SIZE:
        return f"{path}: more than {MAX_SIZE} bytes: this is not a parameter file"
    try:
        return path.name, data.decode("utf-8")
    except UnicodeDecodeError:
        return f"{path}: this is not a text file"
