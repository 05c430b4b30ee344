"""The options of keys name the ways to show and to enter a secret."""

from __future__ import annotations

import argparse

import pytest

from link.signing.key_actions import ShownAs
from link.signing.key_input import SecretForm
from link.signing.key_options import ENTERED, SHOWN, Options


def parse(options: Options, *words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    for name, arguments in options.items():
        parser.add_argument(name, **arguments)
    return parser.parse_args(words)


@pytest.mark.parametrize("shown", ShownAs)
def test_each_way_to_show_a_secret_is_an_option(shown: ShownAs) -> None:
    assert ShownAs(parse(SHOWN, f"--{shown.value}").shown_as) is shown
    assert parse(SHOWN).shown_as is None


@pytest.mark.parametrize("form", [form for form in SecretForm if form is not SecretForm.HEX])
def test_each_way_to_enter_a_secret_is_an_option(form: SecretForm) -> None:
    assert SecretForm(parse(ENTERED, f"--{form.value}").form) is form


def test_hex_digits_name_their_file() -> None:
    assert parse(ENTERED, "--hex", "-").hex == "-"
    assert set(ENTERED) == {f"--{form.value}" for form in SecretForm}
