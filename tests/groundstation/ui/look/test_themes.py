"""Every theme, on every screen, with all the colours that terminals have: what is drawn can be read."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest
from textual.theme import BUILTIN_THEMES
from textual.widgets import Input

import groundstation.ui
from groundstation.config.settings import ThemeName
from groundstation.ui.look.appearance import Look
from groundstation.ui.look.roles import Role
from groundstation.ui.look.themes import THEMES, Colours, ColourTheme, choose_colours
from tests.groundstation.ui import frames, golden_files
from tests.groundstation.ui.contrast import TEXT_CONTRAST, colour_codes, contrast, forget_drawn_styles, luminance, shown
from tests.groundstation.ui.examples import snapshot, waiting
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.ptys import app_on_a_pty
from tests.groundstation.ui.test_goldens import FRAMES, SMALL, STANDING, STOPPED, views_for
from tests.waits import until

COLOURED = [name for name, theme in THEMES.items() if not theme.attributes]

PROBE = {role: f"#{16 + 8 * number:02x}{255 - 8 * number:02x}{number:02x}" for number, role in enumerate(Role)}
"""A colour of its own for each role, to see which roles meet on the screen."""

SCREENS = (
    "drive_140x45", "disarmed_80x24", "waiting_80x24", "warned_80x24", "log_80x24", "params_80x24", "links_80x24",
    "messages_80x24", "goto_80x24", "help_80x24",
)  # fmt: skip

USUAL = {
    *product((Role.TEXT, Role.STRONG, Role.DIM, Role.INFO, Role.KEY, Role.GOOD, Role.CAUTION, Role.BAD),
             (Role.BACKGROUND, Role.PANEL, Role.SELECTED)),
    *((Role.ON_BADGE, ground) for ground in (Role.INFO, Role.KEY, Role.GOOD, Role.CAUTION, Role.BAD)),
}  # fmt: skip
"""Pairs that any screen may draw, whether one of SCREENS does or not."""

GRAPHICS = re.compile("[\u2500-\u259f\u2800-\u28ff ]")
"""Lines, blocks and braille: no text."""


async def show(screen: Console, name: str) -> None:
    """Bring the app to the state of a golden frame."""
    _, picture, keys = FRAMES[name]
    await screen.press(*keys[:1])
    for view in views_for(name):
        screen.station.offer_view(view)
    await screen.show(picture)
    await screen.press(*keys[1:])
    await screen.show(picture)


def test_each_theme_has_all_roles_and_keeps_textuals_variables() -> None:
    own = {role.variable for role in Role} - {"background", "panel"}
    textual = BUILTIN_THEMES["textual-dark"].to_color_system().generate()
    assert not own & set(textual)
    assert set(THEMES) == set(ThemeName)
    for name, sixteen in product(THEMES, (True, False)):
        assert set(choose_colours(name, sixteen=sixteen)) == set(Role)


async def test_all_text_is_readable_in_each_theme_and_colour_depth(monkeypatch: pytest.MonkeyPatch) -> None:
    pairs: set[tuple[Role, Role]] = set()
    with monkeypatch.context() as patch:
        patch.setitem(THEMES, ThemeName.DARK, ColourTheme("", PROBE))
        async with console() as screen:
            for name in SCREENS:
                await screen.begin_anew(*FRAMES[name][:2])
                await show(screen, name)
                pairs |= set(pairs_of(screen))
    assert len(pairs) > 20
    assert not list(unreadable(pairs | USUAL))


def pairs_of(screen: Console) -> Iterator[tuple[Role, Role]]:
    """Yield the roles of all text and of its ground. Fails for a colour that is none of a role."""
    for character, look in (cell for row in frames.cells(screen.app) for cell in row):
        ink, ground = (role_of(colour, PROBE) for colour in frames.colours(look))
        assert ground is not None, (character, look)
        if not GRAPHICS.match(character):
            assert ink is not None, (character, look)
            yield ink, ground


def role_of(colour: str, theme: Colours) -> Role | None:
    """Return the role whose colour this is; Textual rounds."""
    parts = shown(colour, "all")
    near = (
        role
        for role, known in theme.items()
        if all(abs(a - b) <= 2 for a, b in zip(parts, shown(known, "all"), strict=True))
    )
    return next(near, None)


def unreadable(pairs: set[tuple[Role, Role]]) -> Iterator[str]:
    """Yield what cannot be read."""
    for name, depth, (ink, ground) in product(COLOURED, ("all", "256", "xterm", "linux"), sorted(pairs)):
        colours = choose_colours(name, sixteen=depth in ("xterm", "linux"))
        if ground is Role.SELECTED and depth in ("xterm", "linux"):
            ink = Role.ON_SELECTED
        elif ground is Role.SELECTED and ink is Role.DIM:
            ink = Role.MUTED
        ratio = contrast(shown(colours[ink], depth), shown(colours[ground], depth))
        if ratio < TEXT_CONTRAST:
            yield f"{name} {depth}: {ink.name} on {ground.name} {ratio:.2f}"


def looks(screen: Console, text: str) -> set[tuple[bool, bool, bool]]:
    """Return how a text is drawn: bold, reverse, underline."""
    rows = frames.cells(screen.app)
    at = next((y, line.index(text)) for y, line in enumerate(screen.text.splitlines()) if text in line)
    cells = rows[at[0]][at[1] : at[1] + len(text)]
    return {(bool(look.bold), bool(look.reverse), bool(look.underline)) for _, look in cells}


async def test_without_colours_the_text_is_the_same_and_colourless() -> None:
    async with console(look=Look(theme=ThemeName.NO_COLOUR)) as screen:
        for name in ("drive_80x24", "log_140x45", "params_80x24", "links_80x24", "messages_80x24", "goto_80x24"):
            await screen.begin_anew(*FRAMES[name][:2])
            await show(screen, name)
            if "params" not in name and "messages" not in name:
                assert screen.text == golden_files.read(name)
            cells = [look for row in frames.cells(screen.app) for _, look in row]
            assert all(look.color is None and look.bgcolor is None for look in cells), name
            assert {(look.bold, look.reverse) for look in cells} > {(True, False), (True, True)}, name


async def test_without_colours_armed_disarmed_and_estop_look_different() -> None:
    seen = []
    for picture, text in ((snapshot(), "ARMED"), (STANDING, "DISARMED"), (STOPPED, "EMERGENCY STOP")):
        async with console(SMALL, picture, look=Look(theme=ThemeName.NO_COLOUR)) as screen:
            seen.append(looks(screen, f" {text} "))
    assert [len(each) for each in seen] == [1, 1, 1]
    assert len(set.union(*seen)) == 3


@pytest.mark.parametrize("theme", COLOURED)
async def test_the_palette_can_be_read_and_does_not_dim_what_is_behind(theme: ThemeName) -> None:
    async with console(SMALL, snapshot(), look=Look(theme=theme)) as screen:
        await screen.press("ctrl+p")
        await until(lambda: "Neutral at once" in screen.text)
        cells = [cell for row in frames.cells(screen.app) for cell in row if not GRAPHICS.match(cell[0])]
    assert "ARMED" in "".join(character for character, _ in cells)
    for (character, look), depth in product(cells, ("all", "256")):
        ink, ground = (shown(colour, depth) for colour in frames.colours(look))
        assert contrast(ink, ground) >= TEXT_CONTRAST, (character, ink, ground, depth)


async def test_a_theme_of_the_palette_changes_all_that_is_shown() -> None:
    async with console(SMALL, snapshot()) as screen:
        dark = screen.text
        await screen.press("ctrl+p", *"theme", "space", *"light")
        await until(lambda: "Dark text on white" in screen.text)
        await screen.press("enter")
        await screen.show(snapshot())
        await until(lambda: screen.text == dark)
        cells = [frames.colours(look) for row in frames.cells(screen.app) for _, look in row]
        await screen.press("f3")
        cells += [frames.colours(look) for row in frames.cells(screen.app) for _, look in row]
    light = THEMES[ThemeName.LIGHT].colours
    assert all(role_of(ground, light) for ground in {ground for _, ground in cells})
    grounds = [luminance(shown(ground, "all")) for _, ground in cells]
    assert sum(each > 0.5 for each in grounds) > 0.9 * len(grounds)


@pytest.mark.parametrize(
    ("term", "theme", "allowed"),
    [
        ("xterm-256color", ThemeName.NO_COLOUR, set[int]()),
        ("linux", ThemeName.LIGHT, {*range(30, 38), *range(40, 48), *range(90, 98), *range(100, 108)}),
        ("xterm-256color", ThemeName.DARK, {38, 48}),
    ],
)
async def test_the_bytes_for_a_terminal_have_its_colours_only(
    monkeypatch: pytest.MonkeyPatch, term: str, theme: ThemeName, allowed: set[int]
) -> None:
    monkeypatch.delenv("COLORTERM")
    monkeypatch.setenv("TERM", term)
    forget_drawn_styles()
    async with app_on_a_pty(look=Look(theme=theme)) as (_, _, terminal):
        terminal.type("\x10")
        await until(lambda: b"earch for commands" in bytes(terminal.drawn))
    codes = colour_codes(bytes(terminal.drawn))
    assert codes <= allowed
    assert bool(codes) is bool(allowed)
    assert b"\x1b[" in bytes(terminal.drawn)


async def test_with_reduced_motion_nothing_turns_or_blinks() -> None:
    async with console(SMALL, waiting(uptime=1.0), look=Look(reduce_motion=True)) as screen:
        first = screen.text
        await screen.show(waiting(uptime=1.3))
        assert screen.text == first
        assert screen.app.animation_level == "none"
        await screen.press("ctrl+p")
        await until(lambda: not screen.app.screen.query_one(Input).cursor_blink)
    async with console(SMALL, waiting(uptime=1.0)) as screen:
        await screen.show(waiting(uptime=1.3))
        assert screen.text != first


def test_no_other_file_names_a_colour() -> None:
    folder = Path(groundstation.ui.__file__).parent
    named = re.compile(r"#[0-9a-fA-F]{3,8}\b")
    files = [*folder.rglob("*.py"), *folder.rglob("*.tcss")]
    found = {file.name for file in files for line in file.read_text("utf-8").splitlines() if named.search(line)}
    assert found - {"drive.tcss"} == {"themes.py"}
