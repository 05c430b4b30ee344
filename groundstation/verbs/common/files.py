"""Files: the files of whoever typed a verb, read and written whole, wherever the verb runs.

A verb that a station runs has the files of its shell (remote/shell_files.py): those of its folder, its rights and its
pipes. A slow disk then delays the shell, and not the station.
"""

from __future__ import annotations

from enum import StrEnum

from groundstation.verbs.common.exit_codes import ExitCode, VerbError


class FileWork(StrEnum):
    """What is done with a file."""

    READ = "read"
    CHECK_NEW = "check_new"
    WRITE = "write"
    READ_PART = "read_part"
    KEEP_PART = "keep_part"
    STORE = "store"


class Files:
    """The files of this process. Errors are VerbError, one line that names the file."""

    async def do(self, work: FileWork, path: str, data: bytes = b"", *, overwrite: bool = False) -> bytes:
        """Do something with a file; return what was read. Raises VerbError."""
        return work_on(work, path, data, overwrite)

    async def read_bytes(self, path: str) -> bytes:
        """Return the content of a file. Raises VerbError."""
        return await self.do(FileWork.READ, path)

    async def read_text(self, path: str) -> str:
        """Return the text of a file. Raises VerbError."""
        try:
            return (await self.read_bytes(path)).decode("utf-8")
        except UnicodeDecodeError:
            raise VerbError(ExitCode.USAGE, f"{path}: this is not a text file") from None

    async def check_new(self, path: str, *, overwrite: bool) -> None:
        """Raise VerbError if a file cannot be created there, before the work begins."""
        await self.do(FileWork.CHECK_NEW, path, overwrite=overwrite)

    async def write_text(self, path: str, text: str) -> None:
        """Write a file, whole or not at all. Raises VerbError."""
        await self.do(FileWork.WRITE, path, text.encode("utf-8"))

    async def read_part(self, path: str) -> bytes:
        """Return what an earlier download of this file left; nothing if there was none. Raises VerbError."""
        return await self.do(FileWork.READ_PART, path)

    async def keep_part(self, path: str, data: bytes) -> None:
        """Keep the beginning of a file for the next download. Raises VerbError."""
        if data:
            await self.do(FileWork.KEEP_PART, path, data)

    async def store(self, path: str, data: bytes) -> None:
        """Write a whole download, and remove what was kept of it. Raises VerbError."""
        await self.do(FileWork.STORE, path, data)


def work_on(work: FileWork, path: str, data: bytes, overwrite: bool) -> bytes:
    """Do something with a file of this process; return what was read. Raises VerbError."""
    from groundstation.disk import local_file  # with FTP, which most verbs do without
    from groundstation.verbs.common.local_file import check_new_file, file_errors

    with file_errors():
        match work:
            case FileWork.READ:
                return local_file.read_bytes(path)
            case FileWork.READ_PART:
                return local_file.read_part(path)
            case FileWork.CHECK_NEW:
                check_new_file(path, overwrite=overwrite)
            case FileWork.WRITE:
                local_file.write_bytes(path, data)
            case FileWork.KEEP_PART:
                local_file.keep_part(path, data)
            case FileWork.STORE:
                local_file.store(path, data)
        return b""
