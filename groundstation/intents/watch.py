"""Watch: the views that a screen wants. A module of its own, because it needs the classes of all views."""

from __future__ import annotations

from groundstation.intents.base import Intent
from groundstation.views.union import AnyRequest


class Watch(Intent, frozen=True):
    """Send these views from now on, and no others: what the screen on top needs beside the snapshot."""

    is_input = False
    valid_when_late = True
    requests: tuple[AnyRequest, ...] = ()
