"""Styles of roles in the theme in use."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from rich.color import Color, ColorSystem

from groundstation.config.settings import ThemeName
from groundstation.ui.look.colours import badge, style, theme_changes, use_theme
from groundstation.ui.look.roles import Role
from groundstation.ui.look.themes import THEMES


@pytest.fixture(autouse=True)
def _dark_again() -> Iterator[None]:
    yield
    use_theme(ThemeName.DARK)


def test_a_style_is_that_of_the_theme_in_use() -> None:
    before = theme_changes()
    for name in (ThemeName.LIGHT, ThemeName.DARK):
        use_theme(name)
        look = style(Role.BAD, Role.PANEL)
        assert look.color is not None
        assert look.bgcolor is not None
        assert look.color.name == THEMES[name].colours[Role.BAD]
        assert look.bgcolor.name == THEMES[name].colours[Role.PANEL]
    assert theme_changes() == before + 2


@pytest.mark.parametrize("role", [Role.SELECTED, Role.MUTED, Role.DIM, Role.TEXT, Role.LINE])
def test_greys_stay_grey_with_256_colours(role: Role) -> None:
    colour = Color.parse(THEMES[ThemeName.DARK].colours[role])
    red, green, blue = colour.downgrade(ColorSystem.EIGHT_BIT).get_truecolor()
    assert red == green == blue


def test_earth_stays_brown_with_256_colours() -> None:
    colour = Color.parse(THEMES[ThemeName.DARK].colours[Role.EARTH])
    assert colour.downgrade(ColorSystem.EIGHT_BIT).get_truecolor().hex == "#875f00"


def test_dark_text_on_a_badge_is_not_bold() -> None:
    """Terminals with 16 colours draw bold black as grey."""
    assert not badge(Role.KEY).bold


def test_with_16_colours_text_on_the_selected_row_has_one_colour() -> None:
    """Red on grey and grey on grey cannot be read: key caps vanished in an xterm without TERM=xterm-256color."""
    use_theme(ThemeName.DARK, sixteen=True)
    assert {style(role, Role.SELECTED).color for role in (Role.DIM, Role.TEXT, Role.BAD)} == {Color.parse("#ffffff")}


def test_without_colours_states_differ_by_attributes() -> None:
    use_theme(ThemeName.NO_COLOUR)
    armed, stopped, disarmed = (
        badge(Role.DANGER),
        badge(Role.BAD),
        style(Role.TEXT, Role.SELECTED, bold=True),
    )
    looks = [(each.bold, each.reverse, each.underline) for each in (armed, stopped, disarmed, style())]
    assert len(set(looks)) == 4
    assert armed.reverse
    assert stopped.reverse
    assert not disarmed.reverse
    assert all(each.color is None and each.bgcolor is None for each in (armed, stopped, disarmed))
