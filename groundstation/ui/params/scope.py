"""Which parameters the table shows: all, those that have changed, a group ... and the list to choose from."""

from __future__ import annotations

from enum import Enum

import msgspec

from groundstation.views.params import ParamPage


class ScopeKind(Enum):
    """What the parameters of a scope have in common."""

    ALL = "all"
    CHANGED = "changed"
    PENDING = "pending"
    FAVOURITES = "favourites"
    GROUP = "group"


class ParamScope(msgspec.Struct, frozen=True):
    """A choice of parameters."""

    kind: ScopeKind = ScopeKind.ALL
    group: str = ""

    @property
    def label(self) -> str:
        """Its name in the list."""
        return self.group or self.kind.value


ALL = ParamScope()
CHANGED = ParamScope(ScopeKind.CHANGED)


class ScopeRow(msgspec.Struct, frozen=True):
    """A row of the list."""

    scope: ParamScope
    count: int
    changed: int = 0
    pending: int = 0


def scope_rows(page: ParamPage | None, pending: dict[str, str], favourites: int) -> tuple[ScopeRow, ...]:
    """Return the list. `pending`: name of a changed parameter -> its group, empty where that is not known."""
    if page is None:
        return ()
    counts = list(pending.values())
    changed = ScopeRow(CHANGED, page.changed, page.changed)
    return (
        ScopeRow(ALL, page.known),
        *([changed] if page.has_defaults else []),
        ScopeRow(ParamScope(ScopeKind.PENDING), len(pending), pending=len(pending)),
        ScopeRow(ParamScope(ScopeKind.FAVOURITES), favourites),
        *(
            ScopeRow(ParamScope(ScopeKind.GROUP, each.name), each.count, each.changed, counts.count(each.name))
            for each in page.groups
        ),
    )


def group_of(name: str, page: ParamPage) -> str:
    """Return the group of a name: the station shortens numbered ones (RC1 and RC2 are RC)."""
    head = name.partition("_")[0]
    known = {each.name for each in page.groups}
    return head if head in known else head.rstrip("0123456789")
