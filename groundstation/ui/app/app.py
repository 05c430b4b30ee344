"""ConsoleApp: joins the pipe to the station, the key gate and the screens, and renews the lease while its loop runs."""

from __future__ import annotations

import asyncio
import signal
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from textual import events
from textual.app import App, SystemCommand
from textual.await_complete import AwaitComplete
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.filter import LineFilter
from textual.screen import Screen

from groundstation.actions import OperatorAction
from groundstation.input.keymap import KeyEvent, Keymap
from groundstation.intents.session import QUITTING, REST_PERIOD, RenewLease
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import ReleaseControl
from groundstation.snapshot import Snapshot
from groundstation.ui.app.navigation import ROOT, ScreenNavigator, find_row
from groundstation.ui.app.palette import STYLE as PALETTE_STYLE
from groundstation.ui.app.palette import ActionProvider, action_commands, line_commands, theme_commands
from groundstation.ui.app.quitting import Quitting
from groundstation.ui.app.ticks import Ticks
from groundstation.ui.app.view_subscription import ViewSubscription
from groundstation.ui.app.without_looking import Aids, WithoutLooking
from groundstation.ui.base.screen import ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.drive.screen import DriveScreen
from groundstation.ui.keys.gate_checks import AppCondition, find_closure
from groundstation.ui.keys.key_gate import LENT, OTHER_SCREEN, GateClosure, KeyGate, StationConnection
from groundstation.ui.keys.key_hint import KeyHint
from groundstation.ui.keys.pad_input import PadInput, PadSource
from groundstation.ui.keys.pressed_keys import PressedKeys
from groundstation.ui.learn.lesson_dock import ARMED_STILL, LessonDock
from groundstation.ui.look.appearance import PLAIN, Appearance, Look
from groundstation.ui.replay.follower import ReplayFollower
from groundstation.ui.replay.log_child import LogChild
from groundstation.ui.terminal import drawn_lines, interpreter, tty_ping
from groundstation.ui.terminal.console_driver import PING, ConsoleDriver, TerminalClosed
from groundstation.ui.terminal.frozen_terminal import find_proxy, style_refusal
from groundstation.ui.terminal.key_parser import KeyRepeat, KeyUp
from groundstation.ui.terminal.mouse import MouseReport
from groundstation.ui.terminal.picture_output import PictureOutput
from groundstation.ui.terminal.tmux import TmuxSession
from groundstation.ui.terminal.tty_output import TerminalFile
from groundstation.views.base import View
from groundstation.views.line import LineView

TICK = 0.1
"""s between renewals of the lease: a third of LEASE_TIMEOUT, what the station allows. At rest it is REST_PERIOD."""

WITHOUT_SNAPSHOT, AT_REST = 0.25, 0.6
"""s without a drawing after which a tick draws: snapshots come every 0.2 s, and one that is a little late is no reason
to draw twice; and while no vehicle is armed: then they come every 0.5 s."""

MIN_FRAME_TIME = 0.06
"""Least time between two drawings, s. Snapshots in between are skipped: only the newest counts."""


class ConsoleApp(App[int]):
    """One operator at one terminal."""

    COMMANDS: ClassVar[Any] = {ActionProvider}
    CSS = PALETTE_STYLE
    BINDINGS: ClassVar[list[BindingType]] = [Binding("ctrl+z", "suspend_process", "Suspend", show=False)]

    def __init__(
        self,
        client: StationConnection,
        keymap: Keymap,
        *,
        terminal: TerminalFile | None = None,
        folder: Path = Path(),
        look: Look = PLAIN,
        first: str = ROOT.id,
        first_request: int = 1,
        dialect: str | None = None,
        replay_options: Sequence[str] = (),
        gamepad: PadSource | None = None,
        lesson: LessonDock | None = None,
        aids: Aids = Aids(),  # noqa: B008  # frozen
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`first` is the id of the screen that is shown at first, `first_request` the number of its first request.

        `replay_options` are for `mavhelm replay`, which shows logs that are opened here. `lesson` is shown beside all
        screens.
        """
        self._lesson = lesson
        self._replay_options = lambda: [*replay_options, *(lesson.replay_options if lesson is not None else ())]
        drawn_lines.free_with_widget()
        self._proxy = find_proxy()
        self.gate = KeyGate(client, keymap, clock, find_proxy=self._find_proxy)
        self._first = first
        pictures = PictureOutput(None if terminal is None else self._write_to_terminal, self.gate.ping)
        driver: type[Driver] | None = None
        if terminal is not None:
            driver = ConsoleDriver.bind(
                self.gate, terminal, lambda: bool(self.gate.ping.waited(self._clock())), pictures.answers.handle
            )
        super().__init__(driver_class=driver)
        self._client, self._keys, self._terminal, self._clock = client, keymap, terminal, clock
        self._snapshot, self._outage = Snapshot(), client.outage
        self._reading: list[int] = []
        """Descriptors of the client that have not ended."""
        self._pressed = PressedKeys()
        self._key_hint = KeyHint(keymap)
        self._shown_at = 0.0
        self._shown_state = DisplayState(self._snapshot, keymap)
        self._own_loop: asyncio.AbstractEventLoop | None = None
        self._tmux = TmuxSession.from_environment()
        self._gamepad = PadInput(gamepad, self.gate, client.send, self.post_message) if gamepad else None
        self._appearance = Appearance(self, look)
        self._without_looking = WithoutLooking(self, aids)
        context = ScreenContext(
            keymap,
            self._send,
            self.perform_action,
            self._display_state,
            folder,
            lambda file, at: self._log_child.open(self._snapshot, file, at),
            dialect,
            numbers=RequestNumbers(first_request),
            lesson=lesson,
            came_from=lambda: self._navigator.before,
            pictures=pictures,
        )
        self._kept = context.kept
        self.drive = DriveScreen(context)
        self._navigator = ScreenNavigator(self, context, self._appearance.choose_theme)
        self._log_child = LogChild(
            self, self._replay_options, self._say, lambda: self.gate.set_closure(LENT), self._come_back
        )
        self._subscription = ViewSubscription(self._navigator, self._send)
        self._quitting = Quitting(self, client, self.gate, self._log_child, lambda: self._snapshot.left_armed)
        self._replay = ReplayFollower(self._kept, lambda: self._navigator.shown)
        self._ticks = Ticks(TICK, self._tick, self._handle_exception)
        self._pings = Ticks(tty_ping.PERIOD, self._ping, self._handle_exception)
        self._actions = {
            "app.quit": self._quitting.request,
            "drive.gamepad": self._choose_gamepad,
            "view.lesson": self._turn_page,
            "app.mute": lambda: self._say(self._without_looking.switch_mute()),
            **self._navigator.actions,
            **self.drive.actions,
        }

    # ---- start and end ----

    def on_mount(self) -> None:
        """Open the Drive screen, connect the station and start the timers."""
        self.push_screen(self.drive)
        if self._first != ROOT.id:
            self.call_after_refresh(self._navigator.open, find_row(self._first))
        self._own_loop = asyncio.get_running_loop()
        self._reading = self._client.filenos()
        for descriptor in self._reading:
            self._own_loop.add_reader(descriptor, self._readable)
        # In this loop and not in a thread: a UI that hangs must lose its lease.
        self._ticks.start(self._own_loop)
        self._pings.start(self._own_loop)
        self._tmux.start(self._own_loop)
        if self._gamepad is not None:
            self._gamepad.start()

    def on_unmount(self) -> None:
        """Close the gate, which means neutral, before anything else ends."""
        self.gate.close(QUITTING)
        self._ticks.stop()
        self._pings.stop()
        self._tmux.stop()
        self._without_looking.close()
        for descriptor in self._reading:
            asyncio.get_running_loop().remove_reader(descriptor)

    def end(self, code: int = 0) -> None:
        """Close the gate, which means neutral, and leave."""
        self._quitting.end(code)

    def _say(self, note: str) -> None:
        if (shown := self._navigator.shown) is not None:
            shown.say(note)

    def _choose_gamepad(self) -> None:
        if self._gamepad is None:
            self._say("no gamepad: start with --gamepad any")
        else:
            self._gamepad.child.choose_next()

    def _come_back(self) -> None:
        if self._lesson is not None:
            self._lesson.come_back()

    def _turn_page(self) -> None:
        """Turn the page of the lesson; after the last one of a lesson that is done, end this session for the next."""
        if self._lesson is None:
            self._say("no lesson is under way: `mavhelm learn` begins one")
            return
        self._lesson.turn_page(self.size, self._keys)
        if not self._lesson.goes_on:
            self._show()
        elif self._snapshot.left_armed:
            self._lesson.goes_on = False
            self._say(ARMED_STILL)
        else:
            self.end()

    def end_threadsafe(self, code: int) -> None:
        """Leave from a signal handler: takes no lock."""
        if self._own_loop is None:
            raise SystemExit(code)
        self._own_loop.call_soon_threadsafe(self.end, code)

    def on_terminal_closed(self, event: TerminalClosed) -> None:
        """End as after a hang-up."""
        self.end(128 + signal.SIGHUP)

    def push_screen(self, screen: Any, *arguments: Any, **options: Any) -> Any:
        """Close the gate, which means neutral, before another screen is even made; then push it."""
        if screen is not self.drive:
            self.gate.set_closure(OTHER_SCREEN)
            self.gate.screen_opened()
        if isinstance(screen, Screen):
            self._appearance.settle(screen)
        if isinstance(screen, ConsoleScreen):
            screen.call_after_refresh(interpreter.free_closed_screens)
        return super().push_screen(screen, *arguments, **options)

    def pop_screen(self) -> AwaitComplete:
        """Pop the screen on top; what closes towards another screen keeps the keys until that one is open."""
        self._navigator.note_popped(self.screen)
        return super().pop_screen()

    # ---- the station ----

    def _send(self, intent: AnyIntent) -> None:
        self._client.send(intent)

    def _readable(self) -> None:
        """Read the newest snapshot; several may wait."""
        snapshot = self._client.receive()
        for view in self._client.pop_views():
            if isinstance(view, LineView):
                self._navigator.show_line(view)
            else:
                self._show_view(view)
        self._subscription.update()
        if snapshot is not None:
            self._handle_snapshot(snapshot)
        if self._client.outage != self._outage:
            self._outage = self._client.outage
            self._without_looking.handle_outage(self._outage.text)
            self._tick()
        for descriptor in set(self._reading).difference(self._client.filenos()):
            self._reading.remove(descriptor)
            asyncio.get_running_loop().remove_reader(descriptor)
        if not self._client.alive:
            self._quitting.handle_station_ended()

    def _show_view(self, view: View) -> None:
        if (shown := self._navigator.shown) is not None:
            shown.show_view(view)
        if self._lesson is not None:
            self._lesson.see_view(view)

    def _handle_snapshot(self, snapshot: Snapshot) -> None:
        if self._terminal is not None and not self._snapshot.number:
            self.call_after_refresh(interpreter.freeze)  # not before something is shown: it takes 30 ms
        self._replay.follow(snapshot.replay)
        self._snapshot = snapshot
        if self._lesson is not None:
            self._lesson.see(snapshot, self._navigator.current)
        self._without_looking.handle_snapshot(snapshot)
        vehicle, operator = snapshot.vehicle, snapshot.operator
        self._tmux.handle_control(vehicle is not None and vehicle.in_control, any_vehicle=bool(snapshot.left_armed))
        driving = bool(operator.moves or operator.held)
        armed = vehicle is not None and vehicle.armed
        flies = vehicle is not None and vehicle.flies
        proposal = snapshot.proposal.number if snapshot.proposal is not None else 0
        self.gate.update(armed=armed, driving=driving, flies=flies, proposal=proposal)
        interpreter.favour_input(driving or (armed and vehicle is not None and vehicle.in_control))
        self._adapt_ticks()
        if self._clock() - self._shown_at >= MIN_FRAME_TIME:
            self._show()

    def _show(self) -> None:
        self._shown_at = self._clock()
        self._key_hint.note_split(self.gate.split_keys, self._shown_at)
        self._key_hint.note_burst(self.gate.bursts, self._shown_at)
        now = self._shown_state = self._display_state()
        shown = self._navigator.shown
        if shown is not self.drive:
            self.drive.keep_state(now)
        if shown is not None and shown.is_mounted:
            shown.show_state(now)
            self._without_looking.place_cursor(shown)

    def _find_proxy(self) -> str:
        return self._proxy or self._tmux.proxy

    def _display_state(self) -> DisplayState:
        return DisplayState(
            self._snapshot,
            self.gate.keymap,
            closure=self.gate.closure,
            hold=self.gate.hold,
            station_alive=self._client.alive,
            outage=self._outage.text,
            away=self._tmux.away,
            pressed=self._pressed.names,
            key_hint=self._key_hint.text(self._clock()),
            terminal_round_trip=self.gate.ping.round_trip,
            terminal_silence=self.gate.ping.waited(self._clock()),
            promises_releases=self.gate.promises_releases,
            ascii=self._appearance.look.ascii,
            still=self._appearance.look.reduce_motion,
            muted=self._without_looking.muted,
            gamepad=self._gamepad.state(self._clock()) if self._gamepad else None,
            kept=self._kept,
            unseen_lesson="" if self._lesson is None else self._lesson.find_hidden(self.size),
        )

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return the filters of all that is drawn."""
        return self._appearance.filters(super().get_line_filters())

    # ---- timers ----

    def _tick(self) -> None:
        if not self.screen_stack:  # the app has removed its screens, and timers live a little longer
            return
        now = self._clock()
        self._client.send(RenewLease())
        self.gate.set_closure(self._gate_closure(now))
        self._subscription.update()
        if self._tmux.pop_release(now):
            self._send(ReleaseControl(all=True))
        self._pressed.expire(now)
        self._adapt_ticks()
        if now - self._shown_at >= self._patience:
            self._show()

    def _adapt_ticks(self) -> None:
        """Tick seldom while the station rests, no key is lit and no gamepad is read; renew the lease when that ends."""
        rests = self._snapshot.rests and not self._pressed.names and self.gate.hold is None and not self._pad_is_read
        begins = rests != (self._ticks.period == REST_PERIOD)
        if not begins:
            return
        self._ticks.set_period(REST_PERIOD if rests else TICK)
        self._pings.set_period(tty_ping.REST_PERIOD if rests else tty_ping.PERIOD)
        if not rests:
            self._client.send(RenewLease())

    @property
    def _patience(self) -> float:
        """For how many s the last drawing is good enough: what this side knows shows at once if it changes."""
        shown, vehicle = self._shown_state, self._snapshot.vehicle
        unchanged = (
            self.gate.hold is None is shown.hold
            and self.gate.closure == shown.closure
            and self._pressed.names == shown.pressed
            and self._client.alive == shown.station_alive
            and self._outage.text == shown.outage
        )
        if not unchanged:
            return MIN_FRAME_TIME
        armed = vehicle is not None and vehicle.armed
        return WITHOUT_SNAPSHOT if armed or self._pad_is_read else AT_REST

    @property
    def _pad_is_read(self) -> bool:
        return self._gamepad is not None and self._gamepad.child.awake

    def _ping(self) -> None:
        driver, lent = self._driver, self._log_child.running  # a ping would go unanswered
        if isinstance(driver, ConsoleDriver) and driver.reads and not lent and self.gate.ping.next_due(self._clock()):
            driver.write(PING)

    def _write_to_terminal(self, text: str) -> None:
        if isinstance(self._driver, ConsoleDriver):
            self._driver.write(text)

    def _gate_closure(self, now: float) -> GateClosure | None:
        """Return why keys must not drive now, as far as the UI knows; None when they may."""
        return find_closure(
            AppCondition(
                leaving=self._quitting.closure,
                station_alive=self._client.alive,
                outage=self._outage.text,
                other_screen=self._navigator.closure(),
                detached=self._tmux.detached,
                focus=self.app_focus,
                too_small=self.drive.too_small,
                terminal_silent=self.gate.ping.is_silent(now),
                terminal_stuck=self._terminal is not None and self._terminal.is_stuck(time.monotonic()),
                replay=self._snapshot.replay is not None,
                lent=self._log_child.running,
                style=style_refusal(self._snapshot.operator.style, self._find_proxy()),
                driver=self._snapshot.lease.driver,
            )
        )

    # ---- keys ----

    async def on_event(self, event: events.Event) -> None:
        """Handle a key before any widget does."""
        if isinstance(event, events.Key):
            if not self.screen_stack:
                return  # it arrived while the app removed its screens, and Textual would raise
            if not event.is_forwarded and self._take_key(event):
                return
        await super().on_event(event)
        if isinstance(event, (events.Key, events.AppBlur, events.AppFocus)) and self.screen_stack:
            self.gate.set_closure(self._gate_closure(self._clock()))

    def _take_key(self, event: events.Key) -> bool:
        """Return whether no widget gets the key: quit works everywhere. Without our driver the gate gets it here.

        A held key comes 30 times a second, and no widget does anything with one that the gate has sent.
        """
        if not isinstance(self._driver, ConsoleDriver):
            self.gate.handle_keys([KeyEvent(event.key)])
        action = self._keys.get_action(event.key)
        name = "" if action is None else action.id
        if isinstance(event, KeyRepeat):  # a held key is one request, and snapshots report a key that counts as held
            return name == "app.quit"
        if name == "app.quit":
            self._quitting.request()
            return True
        if self._navigator.closing:
            self._navigator.hold(name)
            return True
        self._light(event.key)
        if name == "app.goto":
            return self._navigator.open_menu_at_once()
        if name == "app.command":
            return self._navigator.open_command_at_once(event.key)
        sent = action is not None and action.intent is not None and self.gate.closure is None
        return sent and self.screen is self.drive and self.app_focus and self.drive.question is None

    def on_key(self, event: events.Key) -> None:
        """Handle a key that the screen on top of Drive did not take: another screen's key, and Escape."""
        if self.screen is self.drive or not isinstance(self.screen, ConsoleScreen):
            return
        action = self._keys.get_action(event.key)
        if action is not None and action.id not in self.drive.actions:
            self.perform_action(action)
        elif event.key == "escape":
            self._navigator.go_back()

    def on_key_up(self, event: KeyUp) -> None:
        """Switch the key cap off."""
        self._pressed.release(event.key)
        if (shown := self._navigator.shown) is not None:
            shown.release_key(event.key)
        if shown is self.drive:
            self.drive.light_keycaps(self._pressed.names)

    def on_mouse_report(self, report: MouseReport) -> None:
        """Give the mouse to the screen on top of Drive. Drive and what lies over a screen have no use for it."""
        if isinstance(self.screen, ConsoleScreen) and self.screen is not self.drive and not self._navigator.closing:
            self.screen.take_mouse(report)

    def _light(self, key: str) -> None:
        self._pressed.press(key, self._clock())
        self._adapt_ticks()
        if self.screen is self.drive:
            self._key_hint.press(key, self._clock(), self.gate.keymap)
            self.drive.light_keycaps(self._pressed.names)

    # ---- actions ----

    def perform_action(self, action: OperatorAction) -> None:
        """Perform an action of the app itself; the others are intents, and the gate has sent them."""
        perform = self._actions.get(action.id)
        if perform is not None:
            perform()

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Return the palette's commands."""
        yield from action_commands(self._keys, self.choose_action)
        yield from line_commands(self._navigator.modes, self._navigator.open_command)
        yield from theme_commands(self._appearance.choose_theme)

    def choose_action(self, action: OperatorAction) -> None:
        """Perform an action from the palette: no key has sent its intent."""
        if action.intent is None:
            self.perform_action(action)
        else:
            self._send(self.gate.allow(action.intent))
