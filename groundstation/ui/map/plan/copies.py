"""Copies of the vehicle's plans, which arrive page by page from the station: for Map and the map of Drive."""

from __future__ import annotations

from groundstation.ui.map.plan.rows import Items
from groundstation.views.base import View, ViewRequest
from groundstation.views.plan import (
    MAX_ITEMS,
    PlanKind,
    PlanPage,
    PlanPageRequest,
    PlanRequest,
    PlanTrackRequest,
    PlanTrackView,
    PlanView,
)


class PlanCopies:
    """The newest PlanView and track, and the items of the three plans of one vehicle."""

    def __init__(self) -> None:
        self.view: PlanView | None = None
        self._track: PlanTrackView | None = None
        self.items: dict[PlanKind, Items] = {}
        """Plans that have arrived whole."""
        self._versions: dict[PlanKind, int] = {}
        self._parts: dict[PlanKind, tuple[int, list[PlanPage]]] = {}

    @property
    def track(self) -> PlanTrackView | None:
        """Where the vehicle has been. The track of another one may have arrived before its PlanView."""
        track = self._track
        return track if track is not None and self.view is not None and track.system == self.view.system else None

    @property
    def requests(self) -> tuple[ViewRequest, ...]:
        """The views to request: the next page of a plan that is not whole, and always the rest."""
        return PlanRequest(), PlanTrackRequest(), *self._page_request()

    def show_view(self, view: View) -> PlanKind | None:
        """Show a view; return the plan that is whole with it. Those of another vehicle are dropped."""
        match view:
            case PlanView():
                if self.view is not None and view.system != self.view.system:
                    self._clear()
                self.view = view
                self._forget_unknown(view)
            case PlanTrackView():
                self._track = view
            case PlanPage() if self.view is not None and view.system == self.view.system:
                expected = self.view.plans[view.kind].version == view.version
                return self._take_page(view) if expected else None
        return None

    def _forget_unknown(self, view: PlanView) -> None:
        """Drop the plans that the station does not know any more: a log was moved to a time before them."""
        for kind in PlanKind:
            if not view.plans[kind].version:
                for kept in (self.items, self._versions, self._parts):
                    kept.pop(kind, None)

    def _clear(self) -> None:
        """Drop what is of another vehicle."""
        for kept in (self.items, self._versions, self._parts):
            kept.clear()

    def _page_request(self) -> tuple[ViewRequest, ...]:
        if self.view is None:
            return ()
        for kind in PlanKind:
            version = self.view.plans[kind].version
            if version and version != self._versions.get(kind) and self.view.plans[kind].count <= MAX_ITEMS:
                part = self._parts.get(kind)
                have = sum(len(page.items) for page in part[1]) if part is not None and part[0] == version else 0
                return (PlanPageRequest(self.view.system, kind, version, have),)
        return ()

    def _take_page(self, page: PlanPage) -> PlanKind | None:
        kind = PlanKind(page.kind)
        version, pages = self._parts.get(kind, (0, []))
        if version != page.version:
            pages = []
        if page.version == self._versions.get(kind) or page.first != sum(len(each.items) for each in pages):
            return None
        pages.append(page)
        self._parts[kind] = page.version, pages
        items = tuple(item for each in pages for item in each.items)
        if len(items) < page.count and page.items:
            return None
        del self._parts[kind]
        self.items[kind], self._versions[kind] = items, page.version
        return kind
