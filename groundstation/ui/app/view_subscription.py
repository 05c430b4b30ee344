"""ViewSubscription: tells the station which screen is shown and which views it needs, when either changes."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.intents.session import ReportScreen
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.ui.app.navigation import ScreenNavigator
from groundstation.views.base import ViewRequest


class ViewSubscription:
    """The screen and the views that the station knows of."""

    def __init__(self, navigator: ScreenNavigator, send: Callable[[AnyIntent], None]) -> None:
        self._navigator, self._send = navigator, send
        self._requests: tuple[ViewRequest, ...] = ()
        self._screen = ""

    def update(self) -> None:
        """Send what has changed."""
        if (requests := self._navigator.requests()) != self._requests:
            self._requests = requests
            self._send(Watch(requests))
        if (screen := self._navigator.current) != self._screen:
            self._screen = screen
            self._send(ReportScreen(screen))
