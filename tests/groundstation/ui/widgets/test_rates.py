"""The messages panel."""

from __future__ import annotations

from groundstation.snapshot import MessageRate
from groundstation.ui.widgets.rates import RatesPanel
from tests.groundstation.ui.examples import RATES
from tests.groundstation.ui.frames import texts


def test_a_table_that_is_too_long_says_so() -> None:
    rates = tuple(MessageRate(name=name, rate=rate, count=count, sent=sent) for name, rate, count, sent in RATES)
    assert texts(RatesPanel(rates).draw(40, 6))[-1] == f"and {len(rates) - 4} more"
    assert len(RatesPanel(rates).draw(40, 30)) == len(rates) + 1
