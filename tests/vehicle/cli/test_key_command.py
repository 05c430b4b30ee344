"""`mavhelm vehicle key`: keys are made, shown on request only, entered, listed and revoked."""

from __future__ import annotations

import io
import os
from pathlib import Path

import pytest

from link.signing.key_file import load_keys
from link.signing.role import SigningRole
from vehicle.cli.main import main


class Shell:
    """Runs `mavhelm vehicle key` with a state folder."""

    def __init__(self, capsys: pytest.CaptureFixture[str], state: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.state = state
        self._capsys = capsys
        self._monkeypatch = monkeypatch

    def run(self, *arguments: str, typed: str = "") -> tuple[int, str, str]:
        self._monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(typed.encode())))
        try:
            code = main(["key", *arguments, "--state", str(self.state)])
        except SystemExit as error:
            code = int(error.code or 0)
        out, err = self._capsys.readouterr()
        assert "Traceback" not in err
        return code, out, err


@pytest.fixture
def shell(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shell:
    return Shell(capsys, tmp_path / "state", monkeypatch)


def secret_of(shell: Shell, name: str) -> str:
    key = load_keys(shell.state / "keys.toml").find(name)
    assert key is not None
    return key.secret.hex()


def test_a_new_key_is_stored_and_not_shown(shell: Shell) -> None:
    code, out, err = shell.run("new", "laptop", "--role", "setup")
    assert code == 0
    key = load_keys(shell.state / "keys.toml").find("laptop")
    assert key is not None
    assert key.role is SigningRole.SET_UP
    assert key.fingerprint in err
    assert out == ""
    assert key.secret.hex() not in err
    assert secret_of(shell, "laptop") not in "".join(shell.run("show")[1:])
    assert shell.run("list")[1] == f"> laptop                    setup  {key.fingerprint}\n"


def test_the_secret_is_shown_on_request_with_one_line_of_warning(shell: Shell) -> None:
    shell.run("new", "laptop")
    code, out, err = shell.run("show", "--hex")
    assert (code, out) == (0, f"{secret_of(shell, 'laptop')}\n")
    assert err.count("\n") == 1
    assert "who sees this" in err


def test_a_qr_code_goes_to_a_terminal_only(shell: Shell) -> None:
    shell.run("new", "laptop")
    code, out, err = shell.run("show", "--qr")
    assert (code, out) == (2, "")
    assert "for a terminal" in err


def test_hex_words_and_passphrases_are_read_from_standard_input(shell: Shell, tmp_path: Path) -> None:
    pytest.importorskip("mnemonic")
    shell.run("new", "laptop")
    words = shell.run("show", "--words")[1]
    shell.state = tmp_path / "other"
    assert shell.run("install", "a", "--words", typed=words)[0] == 0
    assert secret_of(shell, "a") == secret_of(Shell(shell._capsys, tmp_path / "state", shell._monkeypatch), "laptop")
    assert shell.run("install", "b", "--hex", "-", typed="ab" * 32 + "\n")[0] == 0
    assert secret_of(shell, "b") == "ab" * 32
    assert shell.run("install", "c", "--passphrase", "--role", "watch", typed="secret_key\n")[0] == 0
    assert secret_of(shell, "c").startswith("6523e58bc0eec42c")


@pytest.mark.parametrize(
    ("arguments", "typed", "expected"),
    [
        (("install", "x"), "", "required"),
        (("install", "x", "--hex", "-"), "zz", "standard input: this is not 64 hex digits"),
        (("install", "x", "--hex", "-"), "abcd", "a key has 32 bytes, this one has 2"),
        (("install", "x", "--hex", "none"), "", "none: No such file"),
        (("install", "x", "--passphrase"), "short\n", "at least 8 characters"),
        (("install", "x", "--passphrase"), "", "the input has ended"),
        (("new", "a b"), "", "a key's name is 1 to 24 letters"),
        (("new", "laptop"), "", "there is a key laptop already"),
        (("new", "x", "--role", "admin"), "", "invalid choice"),
        (("show", "desk"), "", "there is no key 'desk'; there are laptop"),
        (("revoke", "desk"), "", "there is no key 'desk'"),
        ((), "", "ACTION"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line(shell: Shell, arguments: tuple[str, ...], typed: str, expected: str) -> None:
    shell.run("new", "laptop")
    code, out, err = shell.run(*arguments, typed=typed)
    assert (code, out) == (2, "")
    assert expected in err
    assert err.count("\n") == 1


def test_a_key_is_chosen_and_revoked(shell: Shell) -> None:
    shell.run("new", "laptop")
    shell.run("new", "tablet")
    assert shell.run("use", "tablet")[0] == 0
    assert shell.run("list")[1].splitlines()[1].startswith("> tablet")
    assert "1 key is left" in shell.run("revoke", "tablet")[2]
    assert [key.name for key in load_keys(shell.state / "keys.toml").keys] == ["laptop"]


def test_a_file_that_others_can_read_is_refused(shell: Shell) -> None:
    shell.run("new", "laptop")
    os.chmod(shell.state / "keys.toml", 0o644)
    code, _, err = shell.run("list")
    assert code == 2
    assert "chmod 600" in err
