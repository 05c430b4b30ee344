"""What an agent proposes, on each screen: it is shown with keys that count there and have no other use."""

from __future__ import annotations

from textual import events

from groundstation.actions import AGENT_ACTIONS
from groundstation.intents.agents import DeclineProposal, PermitProposal
from groundstation.intents.session import SetKeyGate
from groundstation.screens import SCREENS
from groundstation.snapshot.agents import ProposalView
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.keys.keynames import format_key
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.test_goldens import SMALL

ASKED = ProposalView(number=4, who="mcp (pid 9)", text="drive forward at 60 %", reason="look", seconds=9, left=20)


async def open_screen(screen: Console, name: str) -> ConsoleScreen:
    screen.app._navigator.open_screen(name)
    await screen.pilot.pause()
    await screen.tick()
    top = screen.app.screen
    assert isinstance(top, ConsoleScreen)
    return top


async def test_each_screen_shows_it_with_keys_of_its_own() -> None:
    asked, nothing = snapshot(proposal=ASKED), snapshot()
    async with console(SMALL, asked) as screen:
        for row in SCREENS:
            top = await open_screen(screen, row.id)
            assert isinstance(top, load_screen(row)), row.id
            await screen.show(asked)
            if row.id == "help":  # any key leaves it
                assert not screen.station.of(SetKeyGate)[-1].permits
                continue
            keys = screen.app.gate.keymap.get_keys
            permits, declines = (next(k for k in keys(action) if not top.uses(k)) for action in AGENT_ACTIONS)
            assert f"agent asks: hold {format_key(permits)} to let it, {format_key(declines)} declines" in screen.text
            assert "drive forward at 60 %, at most 9 s" in screen.text, row.id
            assert "“look”" in screen.text, row.id
            if row is SCREENS[0]:
                continue
            assert not any(top.perform_key(events.Key(key, None)) for key in top.agent_keys), row.id
            assert screen.station.of(SetKeyGate)[-1].permits, row.id
            screen.station.intents.clear()
            await screen.hold(permits, lambda: screen.station.of(PermitProposal))
            await screen.press(declines)
            assert screen.station.of(DeclineProposal), row.id
            assert screen.app.screen is top, row.id
            await screen.show(nothing)
            assert "agent" not in screen.text.lower(), row.id


async def test_no_key_permits_it_in_a_text_field_or_a_menu() -> None:
    async with console(SMALL, snapshot(proposal=ASKED)) as screen:
        await open_screen(screen, "log")
        for opens in ("slash", "ctrl+g", "ctrl+p", "colon"):
            await screen.press(opens)
            assert not screen.station.of(SetKeyGate)[-1].permits, opens
            if opens == "slash":
                assert "no key lets it now, a text field has the keys" in screen.text
            await screen.press("escape")
            assert screen.station.of(SetKeyGate)[-1].permits, opens
