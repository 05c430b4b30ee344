"""The view feed of a station: what is made of the parts of the core, and what others add."""

from __future__ import annotations

from collections.abc import Mapping

from groundstation.formats.docs_files import DocsFile
from groundstation.station.core_parts import CoreParts
from groundstation.station.view_feed import ViewFeed, ViewSource
from groundstation.station.views.link_views import LinkViews
from groundstation.station.views.param_views import ParamViews
from groundstation.station.views.plan_views import PlanViews
from groundstation.views.base import ViewRequest
from groundstation.views.log import LogRequest

Sources = Mapping[type[ViewRequest], ViewSource]


def build_view_feed(parts: CoreParts, files: tuple[DocsFile, ...], *others: Sources) -> ViewFeed:
    """Return a feed with all sources. `files`: texts of parameters that the user has."""
    sources: dict[type[ViewRequest], ViewSource] = {
        LogRequest: ViewSource(parts.log.build_page, period=0.1),
        **parts.services.sources,
        **LinkViews(parts).sources,
        **PlanViews(parts.fleet, parts.services).sources,
        **ParamViews(parts.fleet, parts.services, files).sources,
    }
    for each in others:
        sources |= each
    return ViewFeed(sources)
