"""AnyRequest and AnyView: unions of all requests and all views, for the codec between station and screen."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, Union

from groundstation.views import (  # noqa: F401 - defines the classes
    camera,
    charts,
    connect,
    doctor,
    drive,
    files,
    line,
    links,
    log,
    messages,
    params,
    plan,
    replay,
    requests,
)
from groundstation.views.base import View, ViewRequest

if TYPE_CHECKING:
    AnyRequest: TypeAlias = ViewRequest
    AnyView: TypeAlias = View
else:
    # msgspec decodes a union of tagged structs, not their base class.
    AnyRequest = Union[tuple(ViewRequest.__subclasses__())]  # noqa: UP007
    AnyView = Union[tuple(View.__subclasses__())]  # noqa: UP007
"""Any of the requests, and any of the views."""
