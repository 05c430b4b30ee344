"""The lines of a document are typed as they stand, and what does not work is a fault."""

from __future__ import annotations

import shutil
import subprocess
from contextlib import closing
from pathlib import Path

import pytest

from tests.docs_blocks.markdown import find_blocks
from tests.docs_blocks.terminal import LineError
from tests.stranger.computers import ADDRESS, ThisComputer
from tests.stranger.reader import Reader

pytestmark = [pytest.mark.e2e, pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")]


def read(folder: Path, text: str, no_skips: bool = False) -> Reader:
    source = folder / "source"
    subprocess.run(["git", "init", "-q", str(source)], check=True)
    (source / "hello").write_text("hello\n")
    subprocess.run(["git", "-C", str(source), "add", "."], check=True)
    name = ["-c", "user.name=x", "-c", "user.email=x@example.org"]
    subprocess.run(["git", "-C", str(source), *name, "commit", "-qm", "Say hello"], check=True)
    reader = Reader(ThisComputer(folder, source, {"ONE": "1"}), no_skips)
    with closing(reader):
        for block in find_blocks(text):
            reader.type_block(block)
    return reader


def test_lines_are_typed_in_one_terminal_with_empty_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MINE", "1")
    text = f"""
```sh
git clone -q {ADDRESS} mine && cd mine   # a fresh clone
cat hello
test -z "$MINE" && test "$ONE" = 1
echo "WARNING: Retrying (Retry(total=4))"
```
<!-- not run: hardware: a radio -->
```sh
false
```
<!-- not run: root: packages -->
```sh
false
```
```toml
false
```
"""
    assert read(tmp_path, text).typed == 4


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("groundstatoin", "groundstatoin: exit code 127"),
        ("test -e hello", "test -e hello: exit code 1"),
        ("echo DeprecationWarning: old; echo warning: new", "warning: new"),
        ("echo '==== 4 passed, 2 skipped in 1 s ===='", "2 skipped"),
    ],
)
def test_a_line_that_does_not_do_what_it_should_is_a_fault(tmp_path: Path, line: str, fault: str) -> None:
    with pytest.raises(LineError, match=fault):
        read(tmp_path, f"```sh\n{line}\n```\n", no_skips=True)
