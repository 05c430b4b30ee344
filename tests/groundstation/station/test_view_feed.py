"""Which views are sent, and when."""

from __future__ import annotations

from groundstation.station.view_feed import ViewFeed, ViewSource
from groundstation.views.base import View
from groundstation.views.log import LogPage, LogRequest


class Pipe:
    """Keeps the views, or refuses them as a full pipe does."""

    def __init__(self) -> None:
        self.states: list[int] = []
        self.full = False

    def send(self, view: View) -> bool:
        assert isinstance(view, LogPage)
        if not self.full:
            self.states.append(view.state)
        return not self.full


class Source:
    """A log with `newest` lines."""

    def __init__(self) -> None:
        self.newest = 3

    def build(self, request: LogRequest, now: float, wall: float) -> LogPage | None:
        return LogPage((), self.newest) if self.newest > request.after else None


def feed() -> tuple[ViewFeed, Source, Pipe]:
    source = Source()
    return ViewFeed({LogRequest: ViewSource(source.build, period=0.2)}), source, Pipe()


def test_nothing_is_sent_that_no_screen_watches() -> None:
    made, _source, pipe = feed()
    made.send_due(pipe.send, 1.0, 1.0)
    made.watch([LogRequest()])
    made.watch([])
    made.send_due(pipe.send, 2.0, 2.0)
    assert pipe.states == []


def test_the_first_view_is_due_at_once_and_an_equal_one_never() -> None:
    made, _source, pipe = feed()
    made.watch([LogRequest()])
    for step in range(10):
        made.send_due(pipe.send, 1.0 + step, 1.0)
    assert pipe.states == [3]


def test_changes_are_sent_at_sources_rate_and_the_newest_wins() -> None:
    made, source, pipe = feed()
    made.watch([LogRequest()])
    for step in range(41):
        source.newest = 3 + step
        made.watch([LogRequest(max(pipe.states, default=0))])
        made.send_due(pipe.send, 1.0 + step / 40, 1.0)
    assert pipe.states == [3, 11, 19, 27, 35, 43]


def test_a_view_that_the_pipe_did_not_take_is_sent_when_it_does() -> None:
    made, _source, pipe = feed()
    made.watch([LogRequest()])
    pipe.full = True
    made.send_due(pipe.send, 1.0, 1.0)
    pipe.full = False
    made.send_due(pipe.send, 1.01, 1.0)
    assert pipe.states == [3]
