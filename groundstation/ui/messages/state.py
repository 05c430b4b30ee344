"""What is wrong with the messages that arrive, or that none does: one line for the Messages screen."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.snapshot import LinkView
from groundstation.views.messages import MessagesPage

ANOTHER_DIALECT = "--dialect FILE.xml has their names"


def describe_traffic(page: MessagesPage, links: Sequence[LinkView]) -> str:
    """Return what the operator must know of the messages; empty if all is well."""
    if silence := describe_silence(page, links):
        return silence
    unknown = sum(row.unknown for row in page.rows)
    messages = "1 message is" if unknown == 1 else f"{unknown} messages are"
    return f"{messages} unknown here: {ANOTHER_DIALECT}" if unknown else ""


def describe_silence(page: MessagesPage, links: Sequence[LinkView]) -> str:
    """Return what is wrong with a link, or that nothing has arrived yet; empty if messages arrive."""
    if problem := next((f"{link.problem} ({link.name})" for link in links if link.problem), ""):
        return f"{problem} · {ANOTHER_DIALECT}" if "dialect" in problem else problem
    if any(link.frames for link in links) or any(not row.sent for row in page.rows):
        return ""
    count = len(links)
    return f"nothing yet on {count} link{'' if count == 1 else 's'}" if count else "no link: Connect opens one"
