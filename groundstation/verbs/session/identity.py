"""The ids and the session of a verb: its own, those of the verb before it, or those of the station it goes through."""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING

from groundstation.station.component import COMPONENT
from groundstation.verbs.client.station_choice import StationLink
from groundstation.verbs.session.core import WATCHER
from groundstation.verbs.session.kept_session import KeptSession, choose_session

if TYPE_CHECKING:
    from groundstation.verbs.action import VerbAction


def choose_identity(
    action: VerbAction, options: argparse.Namespace, station: StationLink | None
) -> tuple[tuple[int, int], KeptSession]:
    """Return our ids and our session: those of the station that the verb goes through, if it does."""
    if station is not None:
        ready = station.ready
        options.system = ready.system
        return (ready.system, ready.component), KeptSession(ready.session, follows=ready.follows)
    kept = choose_session(options.system, time.monotonic(), take=action.takes_part, follow=action.follows)
    return (options.system, _component(action, kept)), kept


def _component(action: VerbAction, kept: KeptSession) -> int:
    """Return our component id; with that of the verb before a verb that looks goes on with its session."""
    looks = action.watches and not action.examines and not kept.follows
    return WATCHER if looks else COMPONENT
