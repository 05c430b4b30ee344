"""CoreParts: the parts of an OperatorCore, built and joined. What happens in which order is operator_core.py's."""

from __future__ import annotations

from collections.abc import MutableMapping, Sequence

from dialects.enums import Severity
from groundstation.input.style import Style
from groundstation.intents.vehicle import TAKE_OFF_ALTITUDE
from groundstation.station.agents.proposals import ProposalBook
from groundstation.station.component import COMPONENT
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.driving import DrivingController
from groundstation.station.driving.handover import Handover
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.driving.proofs import SessionProofs
from groundstation.station.driving.stops.link_closing import LinkClosing
from groundstation.station.driving.stops.shutdown import StationShutdown
from groundstation.station.links.link_monitor import LinkMonitor
from groundstation.station.links.path_routing import PathRouting
from groundstation.station.notes.operator_log import OperatorLog
from groundstation.station.outbox import StationOutbox
from groundstation.station.services.service_requests import ServiceRequests, TransferPause
from groundstation.station.services.vehicle_queries import VehicleQueries
from groundstation.station.verbs.refusals import Refusals
from groundstation.station.verbs.running_verbs import RunningVerbs
from groundstation.vehicles.fleet import Fleet
from groundstation.vehicles.state.message_log import MessageLog


class CoreParts:
    """Vehicles, operator, driving, commands, services, links and log of one ground station.

    `system` and `component` are our ids, `session` a random number; `proofs`: of the core in whose session this one
    takes part. `take_off`: m above the ground, of its key.
    `docs_cache` has texts of parameters, see VehicleServices.
    """

    def __init__(
        self,
        endpoints: Sequence[str],
        *,
        system: int = 255,
        component: int = COMPONENT,
        style: Style = Style.HOLD,
        speed: float = 0.6,
        take_off: float = TAKE_OFF_ALTITUDE,
        session: int = 0,
        proofs: SessionProofs | None = None,
        docs_cache: MutableMapping[int, bytes] | None = None,
        now: float = 0.0,
    ) -> None:
        ids = self.ids = (system, component)
        self.started = now
        log = self.log = MessageLog()
        outbox = self.outbox = StationOutbox()
        operator = self.operator = OperatorSession(style, speed)
        proofs = self.proofs = proofs or SessionProofs(session)
        fleet = self.fleet = Fleet(log, *ids)
        log.name_of = fleet.name_of
        self.links = LinkMonitor(endpoints, log, system, now)
        stats = self.links.stats
        self.paths = PathRouting(fleet)
        commander = self.commander = Commander(log, outbox, *ids, take_off_altitude=take_off)
        commander.take_off_refusal, commander.altitude_fence = fleet.take_off_refusal, fleet.altitude_fence
        hold = TransferPause(fleet, operator, stats)
        self.services = ServiceRequests(fleet, commander, log, outbox, *ids, texts=docs_cache, is_held=hold.is_held)
        self.driving = DrivingController(operator, proofs, fleet, commander, outbox, ids)
        self.shutdown = StationShutdown(fleet, commander, self.driving)
        self.handover = Handover(fleet, commander, self.driving, log, system)
        self.link_closing = LinkClosing(operator, fleet, stats)
        self.queries = VehicleQueries(fleet, commander, stats, log, self.services, outbox)
        self.verbs = RunningVerbs(fleet, operator, proofs, log, outbox)
        self.proposals = ProposalBook(fleet, operator, commander, log)
        self.driving.report = lambda at, text: log.add(at, "station", text, Severity.WARNING)
        self.driving.is_lent = self.verbs.drives_for_operator
        self.refusals = Refusals(fleet, commander, self.verbs, log)
        self.operator_log = OperatorLog(log)
