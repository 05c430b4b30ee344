"""Key map files: what is accepted, and errors of one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.input.keymap import KEYMAPS, KeymapError
from groundstation.input.keymap_file import PUNCTUATION, flatten, load_keymap, parse_key, parse_keymap


def write(folder: Path, text: str) -> str:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_names() -> None:
    assert load_keymap("standard").bindings == KEYMAPS["standard"]
    assert load_keymap("teleop").name == "teleop"


def test_a_file_replaces_the_keys_of_the_actions_it_names(tmp_path: Path) -> None:
    keymap = load_keymap(write(tmp_path, '[keys]\n"drive.forward" = ["e", ";", "f2"]\n"speed.faster" = "ctrl+up"\n'))
    assert keymap.name == "mine"
    assert keymap.get_keys("drive.forward") == ("e", "semicolon", "f2")
    assert keymap.get_keys("speed.faster") == ("ctrl+up",)
    assert keymap.get_action("i") is None
    assert keymap.get_keys("drive.backward") == ("down", "comma", "s")


def test_a_key_moves_from_the_action_that_had_it(tmp_path: Path) -> None:
    keymap = load_keymap(write(tmp_path, '[keys]\n"drive.forward" = ["s"]\n'))
    assert keymap.get_keys("drive.backward") == ("down", "comma")


def test_an_empty_list_takes_all_keys_away(tmp_path: Path) -> None:
    keymap = load_keymap(write(tmp_path, 'base = "teleop"\n[keys]\n"speed.faster" = []\n'))
    assert keymap.get_keys("speed.faster") == ()
    assert keymap.get_action("q") is None


def test_every_punctuation_name_is_textuals() -> None:
    textual_keys = pytest.importorskip("textual.keys")
    for character, name in PUNCTUATION.items():
        if character != " ":
            assert textual_keys._character_to_key(character) == name


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[keys]\n"drive.up" = ["e"]', ["unknown action 'drive.up'", "drive.forward", "app.quit"]),
        ('[keys]\n"drive.forward" = ["hyperspace"]', ["unknown key 'hyperspace'", "space", "f1 to f24"]),
        ('[keys]\n"drive.forward" = [7]', ["a key must be a string, not 7"]),
        ('[keys]\n"drive.forward" = ["e"]\n"drive.left" = ["e"]', ["'e' is bound to drive.forward and to drive.left"]),
        ('[keys]\n"drive.stop" = []', ["drive.stop needs a key other than escape"]),
        ('[keys]\n"stop.emergency" = ["escape"]', ["stop.emergency needs a key other than escape"]),
        ('base = "emacs"', ["unknown base 'emacs'", "standard, teleop"]),
        ("speed = 1", ["unknown entry 'speed'", "base, keys"]),
        ("keys = 1", ["'keys' must be a table"]),
        ("[keys", ["mine.toml"]),
        (f"base = {'9' * 5000}", ["mine.toml", "a number with thousands of digits"]),
        (f"base = {'[' * 3000}{']' * 3000}", ["mine.toml", "nested too deep"]),
    ],
)
def test_mistakes_are_reported_in_one_line_with_the_choices(tmp_path: Path, text: str, words: list[str]) -> None:
    with pytest.raises(KeymapError) as caught:
        load_keymap(write(tmp_path, text))
    line = str(caught.value)
    assert "\n" not in line
    for word in words:
        assert word in line


def test_a_missing_file_and_an_unknown_name() -> None:
    with pytest.raises(KeymapError, match=r"key map nowhere\.toml: no such file: name one of your own"):
        load_keymap("nowhere.toml")
    with pytest.raises(KeymapError, match=r"unknown key map 'vim': choose standard, teleop or the path"):
        load_keymap("vim")
    with pytest.raises(KeymapError, match=r"unknown key map 'aaaa"):
        load_keymap("a" * 300)
    with pytest.raises(KeymapError, match=r"key map ~nobody-of-this-name/keys\.toml: no such file"):
        load_keymap("~nobody-of-this-name/keys.toml")


def test_the_mark_of_a_windows_editor_is_no_mistake(tmp_path: Path) -> None:
    assert load_keymap(write(tmp_path, '\ufeffbase = "teleop"\r\n')).bindings == KEYMAPS["teleop"]


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "noise.toml"
    path.write_bytes(bytes(range(256)))
    with pytest.raises(KeymapError):
        load_keymap(str(path))


def test_the_example_of_the_help_works() -> None:
    keymap = parse_keymap({"base": "standard", "keys": {"drive.forward": ["e", "up"]}}, "example", "here")
    assert keymap.get_keys("drive.forward") == ("e", "up")


def test_a_file_of_any_name_is_read(tmp_path: Path) -> None:
    path = tmp_path / "keys.conf"
    path.write_text('[keys]\ndrive.forward = "e"\n')
    assert load_keymap(str(path)).get_keys("drive.forward") == ("e",)


def test_names_without_quotes_are_those_of_actions() -> None:
    assert flatten({"drive": {"forward": "e"}, "drive.left": "s"}) == {"drive.forward": "e", "drive.left": "s"}


@pytest.mark.parametrize("base", [["standard"], {}, 3])
def test_a_base_of_another_type_is_reported(base: object) -> None:
    with pytest.raises(KeymapError, match="unknown base"):
        parse_keymap({"base": base}, "mine", "mine.toml")


@pytest.mark.parametrize("key", ["", 3, "f0", "f25", "ctrl+", "\x01", "ctrl+\x01", "ab"])
def test_what_is_no_key_is_reported(key: object) -> None:
    with pytest.raises(KeymapError, match="a key must be a string" if key in ("", 3) else "unknown key"):
        parse_key(key)


def test_keys_with_modifiers() -> None:
    assert [parse_key(key) for key in ("ctrl+x", "ctrl+alt+f24", "ctrl++", "+", "f1")] == [
        "ctrl+x", "ctrl+alt+f24", "ctrl+plus", "plus", "f1",
    ]  # fmt: skip
