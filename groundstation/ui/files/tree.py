"""The file tree of a vehicle as lines: each open folder with what is in it."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import PurePosixPath

import msgspec

from groundstation.views.files import FolderRow

ROOT = "/"


class TreeRow(msgspec.Struct, frozen=True):
    """One line of the tree."""

    path: str
    depth: int
    size: int | None
    """Bytes; None: a folder."""
    opened: bool = False
    count: int | None = None
    """Entries of a folder that is listed."""
    problem: str = ""

    @property
    def name(self) -> str:
        """Last part of the path."""
        return PurePosixPath(self.path).name or ROOT


def build_tree(folders: Iterable[FolderRow], opened: Collection[str]) -> tuple[TreeRow, ...]:
    """Return the lines, from the top folder on."""
    listed = {each.path: each for each in folders}
    rows: list[TreeRow] = []

    def add(path: str, depth: int) -> None:
        folder, is_open = listed.get(path), path in opened
        count = len(folder.entries) if folder is not None and not folder.problem else None
        rows.append(TreeRow(path, depth, None, is_open, count, folder.problem if folder and is_open else ""))
        for entry in folder.entries if folder is not None and is_open else ():
            below = f"{path.rstrip(ROOT)}/{entry.name}"
            if entry.size is None:
                add(below, depth + 1)
            else:
                rows.append(TreeRow(below, depth + 1, entry.size))

    add(ROOT, 0)
    return tuple(rows)
