"""`mavhelm config`, and what the config file does to the programs: exit codes, and nothing opened before."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.cli.main import main

BAD = 'theme = "drak"\nspeed = 7\n'


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "mavhelm" / "groundstation.toml"


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_from_no_file_to_a_checked_one(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "config", "path") == (0, f"{home}\n", "")
    code, out, error = run(capsys, "config", "check")
    assert (code, out) == (7, "")
    assert "`mavhelm config init` writes one" in error
    assert run(capsys, "config", "init") == (0, f"{home}\n", "")
    assert run(capsys, "config", "check") == (0, f"{home}: no mistakes\n", "")
    home.write_text("# mine\n")
    assert run(capsys, "config", "init") == (2, "", f"mavhelm: {home} exists already, and is not changed\n")
    assert home.read_text() == "# mine\n"


def test_the_environment_names_another_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MAVHELM_CONFIG", str(tmp_path / "other.toml"))
    assert run(capsys, "config", "path") == (0, f"{tmp_path}/other.toml\n", "")
    assert run(capsys, "config", "check") == (
        2, "", f"mavhelm: {tmp_path}/other.toml: No such file or directory\n"
    )  # fmt: skip


def test_every_mistake_is_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bad.toml").write_text(BAD)
    lines = (
        f'mavhelm: {tmp_path}/bad.toml:1: theme: "drak" is not one of dark, light, high-contrast, colour-blind, '
        "no-colour; did you mean dark?\n"
        f"mavhelm: {tmp_path}/bad.toml:2: speed: 7 is not a number from 0.1 to 1\n"
    )
    assert run(capsys, "config", "check", f"{tmp_path}/bad.toml") == (2, "", lines)
    assert run(capsys, "config", "show", "--config", f"{tmp_path}/bad.toml") == (2, "", lines)
    assert run(capsys, "--sitl", "--config", f"{tmp_path}/bad.toml") == (2, "", lines)
    assert run(capsys, "modes", "--config", f"{tmp_path}/bad.toml") == (2, "", lines)


def test_show_says_where_each_value_is_from(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    home.parent.mkdir()
    home.write_text('speed = 0.3\n[endpoints]\nfield = "udpout:10.0.0.2:14550"\n')
    code, out, _ = run(capsys, "config", "show", "field", "--style", "latch")
    rows = [line.split(maxsplit=2) for line in out.splitlines()]
    assert code == 0
    assert ["speed", f"{home}:1", "0.3"] in rows
    assert ["style", "--style", "latch"] in rows
    assert ["system", "default", "255"] in rows
    assert rows[0][:2] + rows[0][2].split() == ["open", "command", "line", '["field"]']
    assert len(rows) == 30


def test_show_names_what_is_no_endpoint(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    home.parent.mkdir()
    home.write_text('[endpoints]\nfield = "udpout:10.0.0.2:14550"\n')
    code, _, error = run(capsys, "config", "show", "fild")
    assert code == 2
    assert "did you mean field?" in error


def test_a_named_endpoint_reaches_the_check_of_the_terminal(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    home.parent.mkdir()
    home.write_text('open = "field"\n[endpoints]\nfield = "udpin:127.0.0.1:14999"\nsitl = "udpin:127.0.0.1:14999"\n')
    for arguments in ((), ("field",), ("sitl",), ("--theme", "light", "field")):
        code, _, error = run(capsys, *arguments)
        assert (code, "is not a terminal" in error) == (2, True)


def test_a_wrong_action_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["config", "pth"])
    assert caught.value.code == 2
    assert "choose from" in capsys.readouterr().err
