"""Terminals that would freeze unnoticed: by their processes, and in real GNU screen and mosh."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from groundstation.input.keymap import KeyEvent
from groundstation.intents.driving import SetStyle
from groundstation.ui.keys.key_gate import KeyGate
from groundstation.ui.terminal.frozen_terminal import _list_processes, find_proxy, find_proxy_of_clients, style_refusal
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.ptys import STANDARD
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until


def make_processes(folder: Path, *names: str) -> Path:
    """Make a /proc with processes 10, 11, ...: each is the child of the next; the last one's parent is 0."""
    for at, name in enumerate(names, 10):
        (folder / str(at)).mkdir()
        parent = 0 if at == 9 + len(names) else at + 1
        (folder / str(at) / "status").write_text(f"Name:\t{name}\nUmask:\t0022\nPPid:\t{parent}\n")
    return folder


@pytest.mark.parametrize(
    ("names", "proxy"),
    [
        (("python", "bash", "mosh-server", "systemd"), "mosh"),
        (("python", "bash", "screen", "systemd"), "GNU screen"),
        (("python", "bash", "sshd", "systemd"), ""),
        (("python", "tmux: server", "systemd"), ""),
        ((), ""),
    ],
)
def test_ancestors_tell_who_answers_in_place_of_it(names: tuple[str, ...], proxy: str, tmp_path: Path) -> None:
    assert find_proxy({}, 10, make_processes(tmp_path, *names)) == proxy
    assert find_proxy({"STY": "1.pts-0.host"}, 10, tmp_path) == "GNU screen"


@pytest.mark.parametrize(
    ("names", "proxy"),
    [
        (("tmux: client", "bash", "mosh-server", "systemd"), "mosh"),
        (("tmux: client", "bash", "sshd-session", "sshd", "systemd"), "tmux over ssh"),
        (("tmux: client", "bash", "gnome-terminal", "systemd"), ""),
    ],
)
def test_ancestors_of_a_client_of_tmux_tell_it(names: tuple[str, ...], proxy: str, tmp_path: Path) -> None:
    assert find_proxy_of_clients((10,), make_processes(tmp_path, *names)) == proxy
    assert find_proxy_of_clients((), tmp_path) == ""


LISTED = """
    1     0 /sbin/launchd
   20     1 /opt/homebrew/bin/mosh-server
   21    20 -zsh
   22    21 /Applications/My Terminal.app/Contents/MacOS/My Terminal
   30     1 sshd: me@ttys001
   31    30 tmux
"""


def test_without_procfs_ps_tells_the_ancestors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As macOS lists them: paths, titles, and names with blanks."""
    lists, nowhere = tmp_path / "ps", tmp_path / "proc"
    lists.write_text(f"#!/bin/sh\ncat <<'END'\n{LISTED.strip()}\nEND\n")
    lists.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert [find_proxy({}, pid, nowhere) for pid in (22, 31, 99)] == ["mosh", "", ""]
    assert find_proxy_of_clients((31,), nowhere) == "tmux over ssh"
    lists.write_text("#!/bin/sh\nexit 1\n")
    assert find_proxy({}, 22, nowhere) == ""


def needs(program: str, package: str) -> pytest.MarkDecorator:
    missing = shutil.which(program) is None and "MAVHELM_CI" not in os.environ
    return pytest.mark.skipif(missing, reason=f"{program} is not installed: `sudo apt install {package}`")


@needs("ps", "procps")
def test_the_real_ps_lists_this_process() -> None:
    name, parent = _list_processes()[os.getpid()]
    assert (parent, bool(name)) == (os.getppid(), True)


@pytest.mark.parametrize("style", ["latch", "step"])
def test_only_hold_drives_behind_a_proxy(style: str) -> None:
    assert "mosh hides: style hold only, or plain ssh" in style_refusal(style, "mosh")
    assert style_refusal("hold", "mosh") == style_refusal(style, "") == ""


@pytest.mark.parametrize(("proxy", "chosen"), [("mosh", "hold"), ("", "next")])
def test_the_gate_lets_no_other_style_pass(proxy: str, chosen: str) -> None:
    recorder = Recorder()
    gate = KeyGate(recorder, STANDARD, lambda: 0.0, find_proxy=lambda: proxy)
    why = style_refusal("another one", proxy)
    gate.set_closure(None)
    gate.update(armed=False, driving=False)
    gate.handle_keys([KeyEvent("ctrl+y")])
    assert [each for each in recorder.intents if isinstance(each, SetStyle)] == [SetStyle(style=chosen, why=why)]
    assert gate.allow(SetStyle(style="next")) == SetStyle(style=chosen, why=why)
    recorder.close()


class Inside:
    """`mavhelm` in a terminal of another program, which tmux shows."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.errors, self.code = folder / "errors", folder / "code"
        program = shlex.join([sys.executable, "-m", "groundstation", *arguments])
        self.script = folder / "run.sh"
        self.script.write_text(f"#!/bin/sh\n{program} 2>{self.errors}\necho $? >{self.code}\n")
        self.script.chmod(0o755)
        self._tmux = ("tmux", "-S", str(folder / "tmux"), "-f", "/dev/null")

    def start(self, *command: str) -> None:
        """Run a command in a window of 120x30."""
        line = f"LC_ALL=C.UTF-8 {shlex.join(command)}; exec cat"
        self._run("new-session", "-d", "-x", "120", "-y", "30", line)

    def until(self, text: str) -> None:
        """Wait until the window shows a text."""
        wait_until(lambda: text in self.screen(), self.screen)

    def screen(self) -> str:
        """Return what it shows."""
        return self._run("capture-pane", "-p")

    def press(self, key: str) -> None:
        """Press a key, by tmux's name."""
        self._run("send-keys", key)

    def ended(self) -> tuple[int, str]:
        """Return the exit code and what was written to stderr, once it has ended."""
        wait_until(lambda: self.code.exists() and self.code.read_text(), self.screen)
        return int(self.code.read_text()), self.errors.read_text()

    def end(self) -> None:
        """End all of it."""
        self._run("kill-server")

    def _run(self, *words: str) -> str:
        environment = {name: value for name, value in os.environ.items() if name not in ("TMUX", "TMUX_PANE")}
        done = subprocess.run([*self._tmux, *words], capture_output=True, text=True, timeout=PATIENCE, env=environment)
        return done.stdout


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Inside]]:
    """What is ended with the test."""
    monkeypatch.setenv("SCREENDIR", str(tmp_path / "screens"))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "screens").mkdir(mode=0o700)
    made: list[Inside] = []
    yield made
    for each in made:
        each.end()


def in_screen(inside: Inside) -> None:
    inside.start("screen", "-c", "/dev/null", "-U", str(inside.script))


def in_mosh(inside: Inside) -> None:
    """Run it below mosh-server, with a client on loopback."""
    words = ["mosh-server", "new", "-i", "127.0.0.1", "-p", str(free_port()), "--", str(inside.script)]
    told = subprocess.run(words, capture_output=True, text=True, check=True, env={**os.environ, "LC_ALL": "C.UTF-8"})
    found = re.search(r"MOSH CONNECT (\d+) (\S+)", told.stdout)
    assert found, told
    inside.start("env", f"MOSH_KEY={found[2]}", "mosh-client", "127.0.0.1", found[1])


def in_tmux_in_mosh(inside: Inside) -> None:
    """Run it in a tmux whose client is below mosh-server."""
    program, inside.script = inside.script, inside.script.with_name("inner.sh")
    inner = shlex.join(["tmux", "-S", str(program.with_name("inner")), "-f", "/dev/null", "new-session", str(program)])
    inside.script.write_text(f"#!/bin/sh\nexec env -u TMUX -u TMUX_PANE {inner}\n")
    inside.script.chmod(0o755)
    in_mosh(inside)


PROXIES = [
    pytest.param(in_screen, "GNU screen", marks=needs("screen", "screen"), id="screen"),
    pytest.param(in_mosh, "mosh", marks=needs("mosh-server", "mosh"), id="mosh"),
    pytest.param(in_tmux_in_mosh, "mosh", marks=needs("mosh-server", "mosh"), id="tmux in mosh"),
]


@pytest.mark.e2e
@pytest.mark.tmux
@needs("tmux", "tmux")
@pytest.mark.parametrize(("run", "name"), PROXIES)
def test_latch_is_refused_at_the_start(
    run: Callable[[Inside], None], name: str, tmp_path: Path, opened: list[Inside]
) -> None:
    opened.append(inside := Inside(tmp_path, "--style", "latch", "udpin:127.0.0.1:9"))
    run(inside)
    code, said = inside.ended()
    assert code == 2
    assert said == (
        f"mavhelm: --style latch drives on when the terminal freezes, which {name} hides: "
        "style hold only, or plain ssh\n"
    )


@pytest.mark.e2e
@pytest.mark.tmux
@needs("tmux", "tmux")
@pytest.mark.parametrize(("run", "name"), PROXIES)
def test_the_style_key_says_why_it_stays_hold(
    run: Callable[[Inside], None], name: str, tmp_path: Path, opened: list[Inside]
) -> None:
    with on_line(FakeVehicle()) as vehicle:
        opened.append(inside := Inside(tmp_path, vehicle.endpoint))
        run(inside)
        inside.until("hold r to arm")
        inside.press("C-y")
        inside.until("drive style hold: another one drives on when the terminal freezes, which")
        inside.press("C-c")
        assert inside.ended()[0] == 0
