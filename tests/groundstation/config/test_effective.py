"""Which value wins: the command line, then the environment, then the file, then the default."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.config.config_file import ConfigError, ConfigFile, read_config
from groundstation.config.defaults import DEFAULT_ENDPOINT
from groundstation.config.effective import build_keymap, load_config, merge, resolve_endpoints
from groundstation.config.settings import Settings
from groundstation.input.keymap import KEYMAPS
from link.endpoint import EndpointError

TEXT = """\
open = ["field"]
speed = 0.3
theme = "light"
[endpoints]
field = "udpout:10.0.0.2:14550"
both = ["udpin:127.0.0.1:1", "udpin:127.0.0.1:2"]
[keys]
app.log = "f2"
"""


@pytest.fixture
def file(tmp_path: Path) -> ConfigFile:
    (tmp_path / "my.toml").write_text(TEXT)
    return read_config(tmp_path / "my.toml")


def test_without_anything_the_defaults_hold() -> None:
    effective = merge(None, {}, {})
    assert effective.settings == Settings()
    assert resolve_endpoints(effective.settings.open, effective.settings) == [DEFAULT_ENDPOINT]
    assert effective.sources == {}


def test_the_file_wins_over_the_defaults(file: ConfigFile) -> None:
    effective = merge(file, {}, {})
    assert effective.settings.speed == 0.3
    assert effective.sources["speed"] == f"{file.path}:2"
    assert resolve_endpoints(effective.settings.open, effective.settings) == ["udpout:10.0.0.2:14550"]


def test_the_environment_wins_over_the_file(file: ConfigFile) -> None:
    effective = merge(file, {"MAVHELM_ENDPOINT": "both udpin:127.0.0.1:3", "NO_COLOR": "1"}, {})
    found = resolve_endpoints(effective.settings.open, effective.settings)
    assert found == ["udpin:127.0.0.1:1", "udpin:127.0.0.1:2", "udpin:127.0.0.1:3"]
    assert effective.settings.theme == "no-colour"
    assert (effective.sources["open"], effective.sources["theme"]) == ("MAVHELM_ENDPOINT", "NO_COLOR")


def test_the_command_line_wins_over_the_environment(file: ConfigFile) -> None:
    environment = {"MAVHELM_ENDPOINT": "both", "NO_COLOR": "1"}
    effective = merge(file, environment, {"open": ["field"], "theme": "dark", "speed": 0.9})
    assert (effective.settings.open, effective.settings.theme, effective.settings.speed) == (("field",), "dark", 0.9)
    assert (effective.sources["open"], effective.sources["speed"]) == ("command line", "--speed")


def test_a_mistake_in_the_variable_names_it() -> None:
    with pytest.raises(EndpointError, match=r"^MAVHELM_ENDPOINT: endpoint 'carrier:pigeon'"):
        merge(None, {"MAVHELM_ENDPOINT": "carrier:pigeon"}, {})
    assert merge(None, {"MAVHELM_ENDPOINT": "carrier:pigeon"}, {"open": ["a"]}).settings.open == ("a",), "it loses"


def test_empty_variables_say_nothing(file: ConfigFile) -> None:
    assert merge(file, {"MAVHELM_ENDPOINT": " ", "NO_COLOR": ""}, {}) == merge(file, {}, {})


def test_a_key_map_of_the_command_line_wins_over_the_file(file: ConfigFile) -> None:
    assert build_keymap(merge(file, {}, {}).settings).get_keys("app.log") == ("f2",)
    assert build_keymap(merge(file, {}, {"keymap": "teleop"}).settings).bindings == KEYMAPS["teleop"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("feild", "nor a name of [endpoints]; did you mean field?"),
        ("carrier:pigeon", "it must be one of"),
    ],
)
def test_what_is_no_endpoint_is_named(file: ConfigFile, text: str, words: str) -> None:
    settings = merge(file, {}, {}).settings
    with pytest.raises(EndpointError) as caught:
        resolve_endpoints([text], settings)
    assert words in str(caught.value)


def test_a_file_that_was_named_must_exist_the_own_one_need_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert load_config(None, {}) is None
    for option, environment in ((str(tmp_path / "none.toml"), {}), (None, {"MAVHELM_CONFIG": str(tmp_path / "none")})):
        with pytest.raises(ConfigError, match="No such file"):
            load_config(option, environment)
    (tmp_path / "mavhelm").mkdir()
    (tmp_path / "mavhelm" / "groundstation.toml").write_text(TEXT)
    found = load_config(None, {})
    assert found is not None
    assert found.values["speed"] == 0.3
