"""A speech program for tests: a process that writes down what it is told, and speaks for as long as the test says."""

from __future__ import annotations

from pathlib import Path

from tests.waits import wait_until

_PROGRAM = """\
#!/bin/sh
for text; do :; done
case "$1" in --cancel) echo "cancelled" >> {heard}; exit;; esac
trap 'echo "ended: $text" >> {heard}; exit' TERM
echo "said: $text" >> {heard}
for part in $(seq {tenths}); do sleep 0.1; done
"""


class Ear:
    """The program in a folder, and what it was told."""

    def __init__(self, folder: Path, name: str = "spd-say", *, seconds: float = 0.0) -> None:
        self.folder = folder / "bin"
        self.folder.mkdir(exist_ok=True)
        self._heard = folder / "heard"
        self._heard.touch()
        program = self.folder / name
        program.write_text(_PROGRAM.format(heard=self._heard, tenths=round(seconds * 10)))
        program.chmod(0o755)

    @property
    def heard(self) -> list[str]:
        """What was said and ended, in order."""
        return self._heard.read_text().splitlines()

    def wait_for(self, line: str) -> None:
        """Wait until this was heard."""
        wait_until(lambda: line in self.heard, lambda: f"{line!r}; heard {self.heard}")
