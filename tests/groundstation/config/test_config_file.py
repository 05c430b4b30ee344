"""The config file: what is accepted, and one line with file, line and choices for each mistake."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from groundstation.config.config_file import MAX_SIZE, ConfigError, choose_path, default_path, read_config
from groundstation.config.effective import build_keymap, merge
from groundstation.config.settings import Settings


def write(folder: Path, text: str) -> Path:
    path = folder / "my.toml"
    path.write_text(text, encoding="utf-8")
    return path


def problems(path: Path) -> tuple[str, ...]:
    with pytest.raises(ConfigError) as caught:
        read_config(path, {"param"})
    assert all("\n" not in line for line in caught.value.problems)
    return caught.value.problems


def test_an_empty_file_changes_nothing(tmp_path: Path) -> None:
    assert merge(read_config(write(tmp_path, "")), {}, {}).settings == Settings()


def test_all_settings_at_once(tmp_path: Path) -> None:
    (tmp_path / "keys.toml").write_text('base = "teleop"')
    text = """\
open = "field"
system = 254
style = "latch"
speed = 0.3
keymap = "keys.toml"
theme = "light"
ascii = false
reduce_motion = true
folder = "saved"
log_file = "~/mine.log"
dialect = "ardupilotmega.xml"
[endpoints]
field = "udpout:10.0.0.2:14550"
both = ["serial:/dev/ttyUSB0:57600", "udpin:127.0.0.1:14550"]
[keys]
drive.forward = ["e", "up"]
"app.log" = "f2"
"""
    file = read_config(write(tmp_path, text))
    settings = merge(file, {}, {}).settings
    assert (settings.system, settings.style, settings.speed, settings.theme) == (254, "latch", 0.3, "light")
    assert settings.endpoints["both"] == ("serial:/dev/ttyUSB0:57600", "udpin:127.0.0.1:14550")
    assert settings.folder == str(tmp_path / "saved"), "a path is relative to the folder of the file"
    assert settings.log_file == os.path.expanduser("~/mine.log")
    assert settings.dialect == "ardupilotmega.xml", "one that pymavlink ships"
    keymap = build_keymap(settings)
    assert keymap.get_keys("drive.forward") == ("e", "up")
    assert keymap.get_keys("app.log") == ("f2",)
    assert keymap.get_keys("speed.faster") == ("q",), "the key map is that of the file it names"
    assert file.place("theme") == f"{tmp_path}/my.toml:6"


def test_a_dialect_beside_the_file_or_with_a_folder_is_a_path(tmp_path: Path) -> None:
    (tmp_path / "mine.xml").touch()
    for name in ("mine.xml", "sub/mine.xml", "x" * 300):
        dialect = merge(read_config(write(tmp_path, f'dialect = "{name}"')), {}, {}).settings.dialect
        assert dialect == (name if name.startswith("x") else str(tmp_path / name))


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("sped = 0.3", "1: sped: unknown setting; did you mean speed or speak?"),
        ("\n\nspeed = 2", "3: speed: 2 is not a number from 0.1 to 1"),
        ("take_off = 0.5", "1: take_off: 0.5 is not a number from 1 to 30 m"),
        ("take_off = 100", "1: take_off: 100 is not a number from 1 to 30 m"),
        ("speed = nan", "1: speed: NaN is not a number from 0.1 to 1"),
        ("speed = true", "1: speed: true is not a number from 0.1 to 1"),
        ("system = 0", "1: system: 0 is not a number from 1 to 255"),
        ("system = 1.5", "1: system: 1.5 is not a number from 1 to 255"),
        ('theme = "drak"', '1: theme: "drak" is not one of dark, light, high-contrast, colour-blind, no-colour; '
                           "did you mean dark?"),
        ('ascii = "yes"', '1: ascii: "yes" is not true or false'),
        ("folder = 1", '1: folder: 1 is not text in "quotes"'),
        ('folder = "a\\u0000b"', "1: folder: contains the character NUL; remove it"),
        ('style = "latched"', '1: style: "latched" is not one of hold, latch, step; did you mean latch?'),
        ("open = [1]", '1: open: [1] is not text in "quotes", or a list of texts'),
        ('open = "feild"\n[endpoints]\nfield = "udpin:127.0.0.1:1"',
         "1: open: no name of [endpoints]: 'feild'; did you mean field?"),
        ('open = "carrier:pigeon"', "1: open: endpoint 'carrier:pigeon': it must be one of udpin:HOST:PORT, "
         "udpout:HOST:PORT, tcpin:HOST:PORT, tcpout:HOST:PORT, serial:PATH:BAUD"),
        ("endpoints = 1", "1: endpoints: must be a table, [endpoints]"),
        ('[endpoints]\n"a b" = "udpin:127.0.0.1:1"',
         "2: endpoints.a b: a name has letters, digits, - _ . only, and begins with a letter or digit"),
        ('[endpoints]\nparam = "udpin:127.0.0.1:1"',
         "2: endpoints.param: `mavhelm param` is a command; choose another name"),
        ('[endpoints]\na = "udpin:127.0.0.1:0"',
         "2: endpoints.a: endpoint 'udpin:127.0.0.1:0': port '0' is not a number from 1 to 65535"),
        ('[endpoints]\na = ["udpin:0.0.0.0:1", "udpin:0.0.0.0:1"]',
         "2: endpoints.a: endpoint 'udpin:0.0.0.0:1' is given twice"),
        ("[endpoints]\na = []", '2: endpoints.a: [] is not text in "quotes", or a list of texts'),
        ('keymap = "vim"', "1: keymap: unknown key map"),
        ('keymap = "none.toml"', "1: keymap: key map "),
        ('[keys]\ndrive.sotp = "k"', "2: keys.drive.sotp: unknown action 'drive.sotp': did you mean drive.stop?"),
        ('[keys]\n"app.log" = "f99"', "2: keys.app.log: unknown key 'f99': choose a character"),
        ('theme = "dark"\n[keys]\ndrive.stop = []', "2: keys: drive.stop needs a key other than escape"),
        ('[keys]\nstop.emergency = "escape"', "1: keys: stop.emergency needs a key other than escape"),
        ('[keys]\napp.log = "h"\napp.help = "h"', "1: keys: key 'h' is bound to app.log and to app.help"),
        ("[keys]\nspeed = 0.3", "2: keys.speed: speed is a setting: move its line above [keys]"),
        ("[endpoints]\nstyle = 'hold'", "2: endpoints.style: style is a setting: move its line above [endpoints]"),
        ("keys = []", "1: keys: must be a table, [keys]"),
        ("speed = 0.3\nspeed = 0.4\nsystem = 1", "2: the key is set already"),
        ("speed = 0.3\nstyle =\n", "2: Invalid value"),
        ("[keys]\n[keys]", "2: [keys] exists already, and again; move its lines below the first one"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_with_its_place(tmp_path: Path, text: str, line: str) -> None:
    path = write(tmp_path, text)
    [problem] = problems(path)
    assert problem.startswith(f"{path}:{line}")


def test_every_mistake_is_reported_in_the_order_of_the_file(tmp_path: Path) -> None:
    path = write(tmp_path, 'theme = 1\nspeed = 9\n[keys]\ndrive.stop = "?!"\n"app.log" = 1\n[endpoints]\na = 1\n')
    assert [line.split(":")[1] for line in problems(path)] == ["1", "2", "4", "5", "7"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"theme = 'd\xe4rk'", "byte 11 is not UTF-8 text"),
        (b"\x00" * 10, "Invalid"),
        (b"#" * (MAX_SIZE + 1), "is larger than 262144 bytes"),
        (b"a = " + b"[" * 3000 + b"]" * 3000, "nested too deep"),
        (b"system = " + b"9" * 5000, "thousands of digits"),
    ],
)
def test_what_is_no_text_is_one_line(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "my.toml"
    path.write_bytes(content)
    [problem] = problems(path)
    assert words in problem
    assert problem.startswith(str(path))


def test_what_cannot_be_read_is_one_line(tmp_path: Path) -> None:
    assert problems(tmp_path) == (f"{tmp_path}: is a directory; name a file in it",)
    assert problems(tmp_path / "none.toml") == (f"{tmp_path}/none.toml: No such file or directory",)
    os.mkfifo(tmp_path / "pipe.toml")
    assert problems(tmp_path / "pipe.toml") == (f"{tmp_path}/pipe.toml: is not a regular file",)


def test_the_place_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert default_path() == tmp_path / "mavhelm" / "groundstation.toml"
    assert choose_path(None, {}) == (default_path(), False)
    assert choose_path(None, {"MAVHELM_CONFIG": ""}) == (default_path(), False)
    assert choose_path(None, {"MAVHELM_CONFIG": "/a.toml"}) == (Path("/a.toml"), True)
    assert choose_path("/b.toml", {"MAVHELM_CONFIG": "/a.toml"}) == (Path("/b.toml"), True)


def test_mistakes_in_the_table_of_the_gamepad_have_their_lines(tmp_path: Path) -> None:
    text = 'gamepad = "any"\n[pad]\ndeadmen = "a"\nexpo = 3\nb = "drive.left"\n'
    unknown, expo, drives = problems(write(tmp_path, text))
    assert unknown.endswith("my.toml:3: pad.deadmen: unknown entry; did you mean deadman or dead_zone?")
    assert expo.endswith("my.toml:4: pad.expo: 3 is not a number from 0 to 1")
    assert "my.toml:5: pad.b: drive.left drives, which only the sticks do" in drives
    [both] = problems(write(tmp_path, '[pad]\ndeadman = "x"\nx = "vehicle.hold"\n'))
    assert both.endswith("my.toml:1: pad: x is the dead-man button and cannot be vehicle.hold as well")
