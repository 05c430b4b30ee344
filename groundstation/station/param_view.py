"""Builds the page of parameters that a screen shows: filtered, sorted by name, only the rows that it has room for."""

from __future__ import annotations

from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.param_requests import param_type_name
from groundstation.views.params import ParamPage, ParamPageRequest, ParamRow
from groundstation.views.requests import RequestsView
from link.services.param.client import Param
from link.services.param.values import same_float32

MAX_ROWS = 200
"""Rows of one page: more than the largest terminal shows."""


def build_param_page(contact: Contact, request: ParamPageRequest, requests: RequestsView) -> ParamPage:
    """Return the page that a screen requests, of one vehicle; `requests` are those for parameters."""
    services = contact.services
    params = services.params.client.params if services else {}
    chosen = [param for name, param in sorted(params.items()) if _matches(param, request)]
    first = max(0, min(request.first, len(chosen) - 1))
    return ParamPage(
        system=contact.state.system,
        rows=tuple(map(_row, chosen[first : first + min(request.rows, MAX_ROWS)])),
        first=first,
        matching=len(chosen),
        known=len(params),
        total=services.params.client.total if services else None,
        has_defaults=any(param.default is not None for param in params.values()),
        running=requests.running,
        ended=requests.ended,
    )


def is_changed(param: Param) -> bool:
    """Return whether a parameter is not at its default; False where that is not known."""
    return param.default is not None and not same_float32(param.value, param.default)


def _matches(param: Param, request: ParamPageRequest) -> bool:
    """Return whether a parameter is chosen: one of the words must be in its name."""
    words = request.filter.upper().split()
    if words and not any(word in param.name.upper() for word in words):
        return False
    return is_changed(param) or not request.changed_only


def _row(param: Param) -> ParamRow:
    return ParamRow(
        name=param.name,
        value=param.value,
        kind=param_type_name(param.kind),
        default=param.default,
        changed=is_changed(param),
    )
