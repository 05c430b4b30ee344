"""The file of `mavhelm config init`: it runs unchanged, and every example in it is valid."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec

from groundstation.config.config_file import read_config
from groundstation.config.effective import merge
from groundstation.config.settings import ROWS, Settings
from groundstation.config.template import EXAMPLES, build_template


def test_unchanged_it_sets_nothing(tmp_path: Path) -> None:
    (tmp_path / "my.toml").write_text(build_template())
    assert merge(read_config(tmp_path / "my.toml"), {}, {}).settings == Settings()


def test_with_every_line_set_it_has_all_settings_and_defaults(tmp_path: Path) -> None:
    text = re.sub(r"^#(\S)", r"\1", build_template(), flags=re.MULTILINE)
    (tmp_path / "my.toml").write_text(text)
    values = read_config(tmp_path / "my.toml").values
    assert set(values) == set(ROWS)
    defaults = msgspec.to_builtins(Settings())
    for name in set(ROWS) - set(EXAMPLES) - {"endpoints", "groups", "keys", "pad"}:
        assert values[name] == defaults[name]


def test_the_example_of_the_document_is_valid(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "docs" / "groundstation.md").read_text()
    [example] = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "my.toml").write_text(example)
    assert set(read_config(tmp_path / "my.toml").values) == {"open", "speed", "theme", "endpoints", "groups", "keys"}


def test_no_line_is_wider_than_the_code() -> None:
    assert max(map(len, build_template().splitlines())) <= 120
