"""Views of the Parameters screen: the rows and texts that it has room for, a comparison, the text of a file."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from msgspec.structs import asdict

from dialects.enums import Autopilot
from groundstation.formats.docs_files import DocsFile
from groundstation.formats.param_compare import compare
from groundstation.formats.param_docs import ParamDocs
from groundstation.formats.param_file import format_params, split_unset, unset_text
from groundstation.formats.param_form import ParamForm
from groundstation.natural_order import natural_key
from groundstation.station.services.service_requests import ServiceRequests
from groundstation.station.view_feed import ViewSource
from groundstation.station.views.param_filter import ParamRanks, choose, count_groups, groups_of, is_changed
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.requests.param_requests import param_type_name
from groundstation.vehicles.requests.param_writer import MAX_CHANGES
from groundstation.views.base import ViewRequest
from groundstation.views.params import (
    ParamDiff,
    ParamDiffRequest,
    ParamExport,
    ParamExportRequest,
    ParamGroup,
    ParamInfo,
    ParamInfoRequest,
    ParamInfos,
    ParamPage,
    ParamPageRequest,
    ParamRow,
)
from link.services.param.client import Param, ParamClient

MAX_ROWS = 200
"""Rows of one page: more than the largest terminal shows."""
MAX_INFOS = 64
"""Parameters whose texts are sent at once."""
MAX_GAPS = 10
"""Missing indexes that are named."""
MAX_TEXT = 200_000
"""Characters of a file, less than a packet of the pipe; QGroundControl's form of 1235 parameters has 60,000."""
PERIOD = 0.25
"""Least s between two views of a kind."""
KEPT_PAGES = 8
"""Pages that are kept while nothing changes: one for each screen, and some that were scrolled over."""
_AUTOPILOTS = {int(Autopilot.ARDUPILOT): "ardupilot", int(Autopilot.PX4): "px4"}


class _Sources(msgspec.Struct, frozen=True):
    """What a ParamSummary is made of."""

    client: ParamClient | None
    version: int
    """Of the client's parameters."""
    docs: ParamDocs
    file: Mapping[str, float]

    def is_same(self, other: _Sources) -> bool:
        """Return whether nothing has changed. Texts and files are replaced as a whole."""
        same = self.client is other.client and self.docs is other.docs and self.file is other.file
        return same and self.version == other.version


class _Rows(msgspec.Struct, frozen=True):
    """Rows of one page."""

    rows: tuple[ParamRow, ...]
    first: int
    matching: int


class ParamSummary:
    """What a page says of all parameters, and the rows of the newest pages. Made anew when one of its sources changes.

    `file`: values to compare with. A page is built four times a second, and parameters change seldom.
    """

    def __init__(self, params: Mapping[str, Param], docs: ParamDocs, file: Mapping[str, float]) -> None:
        self._params, self._docs, self._file = params, docs, file
        self._group_of = groups_of(params)
        self._ranks = ParamRanks()
        self._pages: dict[ParamPageRequest, _Rows] = {}
        self.groups: tuple[ParamGroup, ...] = count_groups(params, self._group_of)
        self.changed = sum(map(is_changed, params.values()))
        self.has_defaults = any(_default(each, docs) is not None for each in params.values())

    def page(self, request: ParamPageRequest) -> _Rows:
        """Return the rows of a request."""
        if (kept := self._pages.get(request)) is not None:
            return kept
        if len(self._pages) >= KEPT_PAGES:
            self._pages.clear()
        chosen = choose(self._params, self._docs, self._group_of, request, self._ranks)
        first = max(0, min(request.first, len(chosen) - 1))
        shown = chosen[first : first + min(request.rows, MAX_ROWS)]
        made = _Rows(tuple(_row(each, self._docs, self._file) for each in shown), first, len(chosen))
        self._pages[request] = made
        return made


class ParamViews:
    """Builds the views of the selected vehicle. `files` are texts that the user has for vehicles without their own."""

    def __init__(self, fleet: Fleet, services: ServiceRequests, files: tuple[DocsFile, ...] = ()) -> None:
        self._fleet = fleet
        self._services = services
        self._files = files
        self._made_of = _Sources(None, 0, ParamDocs(), {})
        self._summary = ParamSummary({}, self._made_of.docs, self._made_of.file)

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {
            ParamPageRequest: ViewSource(self._build_page, PERIOD),
            ParamInfoRequest: ViewSource(self._build_infos, PERIOD),
            ParamDiffRequest: ViewSource(self._build_diff, PERIOD),
            ParamExportRequest: ViewSource(self._build_export, PERIOD),
        }

    # ---- page ----

    def _build_page(self, request: ParamPageRequest, now: float, wall: float) -> ParamPage | None:
        contact = self._fleet.selected
        if contact is None:
            return None
        params, docs = self._params(contact), self._docs(contact)
        client = contact.services.params.client if contact.services else None
        if contact.services is not None and params and not contact.services.params.fetching:
            contact.services.metadata.want()
        missing = client.missing if client else ()
        summary = self._summarize(contact, docs)
        page = summary.page(request)
        system = contact.state.system
        requests = self._services.requests_of("params", system)
        return ParamPage(
            system=system,
            rows=page.rows,
            first=page.first,
            matching=page.matching,
            known=len(params),
            total=client.total if client else None,
            has_defaults=summary.has_defaults,
            running=requests.running,
            ended=requests.ended,
            groups=summary.groups,
            changed=summary.changed,
            missing=len(missing),
            gaps=missing[:MAX_GAPS],
            autopilot=_AUTOPILOTS.get(int(contact.state.autopilot), "other"),
            texts=self._texts(contact, docs),
            file=contact.services.param_file.name if contact.services else "",
        )

    def _summarize(self, contact: Contact, docs: ParamDocs) -> ParamSummary:
        """Return the summary, as it was made before if none of its sources has changed."""
        client = contact.services.params.client if contact.services else None
        made_of = _Sources(client, client.version if client else 0, docs, self._file_values(contact))
        if not made_of.is_same(self._made_of):
            self._made_of = made_of
            self._summary = ParamSummary(client.params if client else {}, docs, made_of.file)
        return self._summary

    def _texts(self, contact: Contact, docs: ParamDocs) -> str:
        """Return where the texts come from, or why there are none."""
        if docs.source:
            return docs.source
        own = contact.services.metadata.problem if contact.services else ""
        return own or next((file.problem for file in self._files if file.problem and _is_for(file, contact)), "")

    # ---- texts ----

    def _build_infos(self, request: ParamInfoRequest, now: float, wall: float) -> ParamInfos | None:
        contact = self._fleet.selected
        if contact is None:
            return None
        params, docs, file = self._params(contact), self._docs(contact), self._file_values(contact)
        names = (name for name in request.names[:MAX_INFOS] if name in params)
        return ParamInfos(contact.state.system, tuple(_info(params[name], docs, file) for name in names))

    # ---- files ----

    def _build_diff(self, request: ParamDiffRequest, now: float, wall: float) -> ParamDiff | None:
        contact = self._fleet.selected
        if contact is None:
            return None
        opened = contact.services.param_file if contact.services else None
        if opened is None or opened.file is None:
            return ParamDiff(contact.state.system, "")
        found = compare(opened.file, self._params(contact), contact.state.component)
        docs = self._docs(contact)
        fixed = {name for name, _, _ in found.loadable if docs.get(name).read_only}
        different = tuple(
            (name, param.value, wanted)
            for name, wanted, param in sorted(found.loadable, key=lambda each: natural_key(each[0]))
            if name not in fixed
        )
        return ParamDiff(
            contact.state.system,
            opened.name,
            found.same,
            different[:MAX_CHANGES],
            len(found.only_vehicle),
            found.only_file[:MAX_CHANGES],
            tuple(sorted((*found.own, *fixed), key=natural_key))[:MAX_CHANGES],
        )

    def _build_export(self, request: ParamExportRequest, now: float, wall: float) -> ParamExport | None:
        contact = self._fleet.selected
        if contact is None:
            return None
        params = self._params(contact)
        if request.changed_only and all(param.default is None for param in params.values()):
            return ParamExport(request.number, "", 0, "this vehicle does not report defaults: save all")
        groups = groups_of(params)
        page = ParamPageRequest(changed_only=request.changed_only, group=request.group)
        chosen, unset = split_unset(choose(params, ParamDocs(), groups, page, ParamRanks()))
        if not chosen:
            return ParamExport(request.number, "", 0, "there is nothing to save")
        state = contact.state
        text = format_params(chosen, ParamForm(request.form), vehicle=state.system, component=state.component)
        if len(text) > MAX_TEXT:
            return ParamExport(request.number, "", 0, "too many parameters for the screen: mavhelm param save")
        return ParamExport(request.number, text, len(chosen), left_out=unset_text(unset))

    # ---- parts ----

    def _params(self, contact: Contact) -> Mapping[str, Param]:
        return contact.services.params.client.params if contact.services else {}

    def _docs(self, contact: Contact) -> ParamDocs:
        """Return the vehicle's own texts, else those of the user's first file that fits."""
        own = contact.services.metadata.docs if contact.services else ParamDocs()
        if own.docs:
            return own
        return next((file.docs for file in self._files if file.docs.docs and _is_for(file, contact)), own)

    def _file_values(self, contact: Contact) -> Mapping[str, float]:
        return contact.services.param_file.values if contact.services else {}


def _is_for(file: DocsFile, contact: Contact) -> bool:
    return file.autopilot in (None, contact.state.autopilot)


def _default(param: Param, docs: ParamDocs) -> float | None:
    """Return the default as the vehicle reports it, else as its texts say."""
    return param.default if param.default is not None else docs.get(param.name).default


def _row(param: Param, docs: ParamDocs, file: Mapping[str, float]) -> ParamRow:
    doc = docs.get(param.name)
    return ParamRow(
        name=param.name,
        value=param.value,
        kind=param_type_name(param.kind),
        default=_default(param, docs),
        changed=is_changed(param),
        unit=doc.unit,
        meaning=doc.meaning(param.value),
        file=file.get(param.name),
    )


def _info(param: Param, docs: ParamDocs, file: Mapping[str, float]) -> ParamInfo:
    own = {
        "name": param.name, "value": param.value, "kind": param_type_name(param.kind), "index": param.index,
        "default": _default(param, docs), "file": file.get(param.name),
    }  # fmt: skip
    return ParamInfo(**asdict(docs.get(param.name)) | own)
