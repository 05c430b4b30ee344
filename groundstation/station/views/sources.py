"""Sources of the views that are made of the core's parts alone."""

from __future__ import annotations

from groundstation.formats.docs_files import DocsFile
from groundstation.station.core_parts import CoreParts
from groundstation.station.view_feed import ViewSource
from groundstation.station.views.link_views import LinkViews
from groundstation.station.views.param_views import ParamViews
from groundstation.station.views.plan_views import PlanViews
from groundstation.views.base import ViewRequest
from groundstation.views.log import LogRequest


def core_sources(parts: CoreParts, files: tuple[DocsFile, ...]) -> dict[type[ViewRequest], ViewSource]:
    """Return request -> source. `files`: texts of parameters that the user has."""
    return {
        LogRequest: ViewSource(parts.log.build_page, period=0.1),
        **parts.services.sources,
        **LinkViews(parts).sources,
        **PlanViews(parts.fleet, parts.services).sources,
        **ParamViews(parts.fleet, parts.services, files).sources,
    }
