"""Copies of the vehicle's plans: page by page, another version, another vehicle."""

from __future__ import annotations

from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.map.model import MapModel
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.views.plan import (
    PAGE,
    PlanItem,
    PlanKind,
    PlanPage,
    PlanPageRequest,
    PlanRequest,
    PlanSummary,
    PlanTrackRequest,
    PlanTrackView,
    PlanView,
)
from tests.groundstation.ui.map.plans import HOME, item

ITEMS = tuple(item(north=number) for number in range(PAGE + 30))


def view(version: int = 1, system: int = 1, count: int = len(ITEMS)) -> PlanView:
    return PlanView(
        system=system, name="", autopilot=0, plans=(PlanSummary(version, count), PlanSummary(), PlanSummary())
    )


def page(first: int, items: tuple[PlanItem, ...], *, version: int = 1, system: int = 1) -> PlanPage:
    return PlanPage(system, 0, version, len(ITEMS), first, items)


def page_request(copies: PlanCopies) -> PlanPageRequest | None:
    return next((each for each in copies.requests if isinstance(each, PlanPageRequest)), None)


def test_a_plan_arrives_page_by_page() -> None:
    copies = PlanCopies()
    assert copies.requests == (PlanRequest(), PlanTrackRequest())
    copies.show_view(view())
    assert page_request(copies) == PlanPageRequest(1, 0, 1, 0)
    assert copies.show_view(page(0, ITEMS[:PAGE])) is None
    assert page_request(copies) == PlanPageRequest(1, 0, 1, PAGE)
    assert copies.show_view(page(0, ITEMS[:PAGE])) is None, "again"
    assert copies.show_view(page(PAGE, ITEMS[PAGE:])) is PlanKind.MISSION
    assert copies.items[PlanKind.MISSION] == ITEMS
    assert page_request(copies) is None
    assert copies.show_view(page(PAGE, ITEMS[PAGE:])) is None


def test_another_version_begins_anew() -> None:
    copies = PlanCopies()
    copies.show_view(view())
    copies.show_view(page(0, ITEMS[:PAGE]))
    copies.show_view(view(version=2))
    assert page_request(copies) == PlanPageRequest(1, 0, 2, 0)
    assert copies.show_view(page(PAGE, ITEMS[PAGE:])) is None, "of the version before"
    copies.show_view(page(0, ITEMS[:PAGE], version=2))
    assert copies.show_view(page(PAGE, ITEMS[PAGE:], version=2)) is PlanKind.MISSION


def test_an_empty_plan_is_whole() -> None:
    copies = PlanCopies()
    copies.show_view(view(count=0))
    assert copies.show_view(PlanPage(1, 0, 1, 0, 0, ())) is PlanKind.MISSION
    assert copies.items[PlanKind.MISSION] == ()


def test_a_plan_that_a_log_does_not_have_yet_is_forgotten() -> None:
    model = MapModel(RequestNumbers())
    model.show_view(view())
    model.show_view(page(0, ITEMS[:PAGE]))
    model.show_view(page(PAGE, ITEMS[PAGE:]))
    assert model.editor.items(PlanKind.MISSION) == ITEMS
    model.show_view(view(version=0, count=0))
    assert model.editor.items(PlanKind.MISSION) == ()
    model.show_view(view())
    assert page_request(model.copies) == PlanPageRequest(1, 0, 1, 0)


def test_another_vehicle_has_plans_of_its_own() -> None:
    copies = PlanCopies()
    copies.show_view(view())
    copies.show_view(page(0, ITEMS[:PAGE]))
    copies.show_view(page(PAGE, ITEMS[PAGE:]))
    copies.show_view(PlanTrackView(2, HOME, ((1.0, 2.0),)))
    assert copies.track is None
    copies.show_view(view(system=2))
    assert copies.items == {}
    assert copies.track is not None
    assert page_request(copies) == PlanPageRequest(2, 0, 1, 0)
    assert copies.show_view(page(0, ITEMS, system=1)) is None
