"""The ids and the session of a verb with links of its own: its own, or those of the verb before it."""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING

from groundstation.station.component import COMPONENT
from groundstation.verbs.session.core import WATCHER
from groundstation.verbs.session.kept_session import KeptSession, choose_session

if TYPE_CHECKING:
    from groundstation.verbs.action import VerbAction


def choose_identity(action: VerbAction, options: argparse.Namespace) -> tuple[tuple[int, int], KeptSession]:
    """Return our ids and our session; with those of the verb before, a verb that looks goes on with its session."""
    kept = choose_session(options.system, time.monotonic(), take=action.takes_part, follow=action.follows)
    looks = action.watches and not action.examines and not kept.follows
    return (options.system, WATCHER if looks else COMPONENT), kept
