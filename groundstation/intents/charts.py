"""Intents of the Charts screen."""

from __future__ import annotations

from groundstation.intents.base import Intent
from groundstation.views.charts import FieldId


class PinSeries(Intent, frozen=True):
    """Record these fields also when they are not drawn any more, in place of those pinned before."""

    is_input = False
    valid_when_late = True
    fields: tuple[FieldId, ...] = ()
