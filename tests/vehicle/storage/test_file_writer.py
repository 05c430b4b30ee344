"""FileWriter on a slow disk."""

from __future__ import annotations

import threading
from functools import partial
from pathlib import Path

from vehicle.storage.file_writer import FileWriter


def test_a_slow_disk_gets_the_newest_of_many_wishes(tmp_path: Path) -> None:
    released, writing = threading.Event(), threading.Event()
    made: list[str] = []

    def slow() -> bytes:
        writing.set()
        assert released.wait(60)
        return b"first"

    def made_of(word: str) -> bytes:
        made.append(word)
        return word.encode()

    writer = FileWriter(tmp_path)
    writer.write("parameters", slow)
    assert writing.wait(60)
    for number in range(1000):
        writer.write("parameters", partial(made_of, f"{number}"))
    writer.write("fence", partial(made_of, "fence"))
    released.set()
    writer.close()
    assert made == ["999", "fence"]
    assert [(tmp_path / name).read_bytes() for name in ("parameters", "fence")] == [b"999", b"fence"]
