"""Client half of the command protocol: sends COMMAND_LONG or COMMAND_INT and repeats it until COMMAND_ACK.

Rules (https://mavlink.io/en/services/command.html): repeats of a COMMAND_LONG have a rising `confirmation`, COMMAND_INT
has none; IN_PROGRESS extends the timeout. Our vehicle rejects what comes over a link of the driver that was not proven
in the last second (ROVER_REJECTION_NO_PROOF): it is repeated likewise, because proofs go on.
A vehicle that answers COMMAND_INT_ONLY or COMMAND_LONG_ONLY gets the command
in the other form, once. A stop that is not answered goes in both forms in turn.
"""

from __future__ import annotations

import msgspec

from dialects.command_places import to_command_int, to_command_long
from dialects.enums import Rejection, Result
from dialects.messages import CommandAck, CommandInt, CommandLong, Message
from link.core import Outgoing, Received
from link.services.command.request import PROGRESS_TIMEOUT, Params

REPEAT_AFTER = 0.35
"""s without a COMMAND_ACK before a command is repeated: longer than a loaded 57600 baud radio takes (0.18 s)."""
TRIES = 6
"""At 30 % loss each way all six fail once in 55 commands of the worst kind; the operator sees the failure after 2.1
s."""


class CommandPlace(msgspec.Struct, frozen=True):
    """Frame and position of a COMMAND_INT."""

    frame: int
    """MAV_FRAME."""
    x: int
    """Latitude in 1e-7 degrees, or north in 1e-4 m, by frame."""
    y: int


class CommandOutcome(msgspec.Struct, frozen=True):
    """How a command ended."""

    command: int
    params: Params
    target_system: int
    result: Result | None
    """None: no answer."""
    number: int | None = None
    """MAV_RESULT as received, also one without a name here."""
    refusal: str = ""
    """Why it was never sent; its result is DENIED then."""


class _Waiting(msgspec.Struct):
    command: int
    params: Params
    target: tuple[int, int]
    due: float
    place: CommandPlace | None = None
    """Of a COMMAND_INT."""
    further: tuple[int, ...] = ()
    """Further components of the system that get it."""
    stop: bool = False
    other_form: bool = False
    """It goes as COMMAND_INT in place of COMMAND_LONG, or the other way round."""
    refused_form: int | None = None
    """The answer that has asked for the other form."""
    answers: dict[int, int] = msgspec.field(default_factory=dict)
    """Component -> MAV_RESULT of its refusal."""
    sent: int = 0
    rejected: bool = False
    """Its sender's proof was missing at its last try."""
    progress: int | None = None
    """% of a command that is IN_PROGRESS; None: not reported."""


class CommandClient:
    """Sends commands and repeats them until they are acknowledged.

    COMMAND_ACK names the command but not the instance, so a newer command replaces a waiting one of the same kind and
    target.
    """

    def __init__(self, system: int, component: int, outbox: list[Outgoing] | None = None) -> None:
        """`outbox` gets what is to be sent; without one it is kept for `messages_to_send`."""
        self._ids = (system, component)
        self._waiting: dict[tuple[int, int], _Waiting] = {}
        self._outbox = [] if outbox is None else outbox
        self._outcomes: list[CommandOutcome] = []

    def send(
        self,
        command: int,
        *params: float,
        target_system: int,
        target_component: int = 1,
        now: float,
        place: CommandPlace | None = None,
        further: tuple[int, ...] = (),
        stop: bool = False,
        other_form: bool = False,
    ) -> None:
        """Send a command with up to 7 parameters (missing ones are 0) and wait for its COMMAND_ACK.

        With a `place` it is a COMMAND_INT, and parameters 5 and 6 are not used. `further` components get it as well; it
        ends when one accepts or all have refused. A `stop` that is not answered is repeated in both forms in turn,
        beginning with the `other_form` if so wished.
        """
        full: Params = (*params, *(0.0,) * (7 - len(params)))  # type: ignore[assignment]
        target = (target_system, target_component)
        waiting = _Waiting(int(command), full, target, now, place, further, stop)
        waiting.other_form = other_form
        self._waiting[target_system, int(command)] = waiting
        self._transmit(waiting, now)

    def cancel(self, command: int, target_system: int) -> None:
        """Stop repeating a command to a target."""
        self._waiting.pop((target_system, int(command)), None)

    @property
    def busy(self) -> bool:
        """Whether any command still waits for its COMMAND_ACK."""
        return bool(self._waiting)

    def is_waiting(self, command: int, target_system: int) -> bool:
        """Return whether a command of this kind to this system still waits for its COMMAND_ACK."""
        return (target_system, int(command)) in self._waiting

    def progress(self, command: int, target_system: int) -> int | None:
        """Return how far a command is that the vehicle reports as in progress, %; None: not reported."""
        waiting = self._waiting.get((target_system, int(command)))
        return waiting.progress if waiting else None

    def receive(self, received: Received, now: float) -> None:
        """Handle COMMAND_ACK; other messages are ignored."""
        message = received.message
        if not isinstance(message, CommandAck) or message.target_system not in (0, self._ids[0]):
            return
        waiting = self._waiting.get((received.system, message.command))
        if waiting is None:
            return
        if message.result == Result.IN_PROGRESS:
            waiting.sent, waiting.due = 1, now + PROGRESS_TIMEOUT
            waiting.progress = message.progress if message.progress <= 100 else waiting.progress
            return
        if _wants_proof(message):
            waiting.rejected = True  # repeated when it is due; the proofs of the session go on meanwhile
            return
        if _asks_for_other_form(message.result, waiting):
            waiting.other_form, waiting.refused_form, waiting.sent = not waiting.other_form, message.result, 0
            self._transmit(waiting, now)
            return
        result = _joint_result(waiting, received.component, message.result)
        if result is None:
            return
        del self._waiting[received.system, message.command]
        known = Result(result) if result in Result._value2member_map_ else Result.FAILED
        self._outcomes.append(CommandOutcome(waiting.command, waiting.params, received.system, known, result))

    def refuse(self, message: Message, why: str) -> None:
        """End the command that `message` carries: it was not sent, because our role does not allow it."""
        if not isinstance(message, (CommandLong, CommandInt)):
            return
        waiting = self._waiting.pop((message.target_system, message.command), None)
        if waiting is not None:
            outcome = CommandOutcome(waiting.command, waiting.params, message.target_system, Result.DENIED, refusal=why)
            self._outcomes.append(outcome)

    def tick(self, now: float) -> None:
        """Repeat overdue commands; give up those repeated TRIES times."""
        for key, waiting in list(self._waiting.items()):
            if now < waiting.due:
                continue
            if waiting.sent >= TRIES:
                del self._waiting[key]
                result = Result.TEMPORARILY_REJECTED if waiting.rejected else None
                self._outcomes.append(CommandOutcome(waiting.command, waiting.params, key[0], result, result))
            else:
                self._transmit(waiting, now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox = self._outbox[:]
        self._outbox.clear()
        return outbox

    def outcomes(self) -> list[CommandOutcome]:
        """Return the commands that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    def _transmit(self, waiting: _Waiting, now: float) -> None:
        if waiting.stop and waiting.sent and not waiting.answers and waiting.refused_form is None:
            waiting.other_form = not waiting.other_form
        for component in _components(waiting):
            self._outbox.append(Outgoing(_message(waiting, component)))
        waiting.sent, waiting.rejected = waiting.sent + 1, False
        waiting.due = now + REPEAT_AFTER


def _wants_proof(answer: CommandAck) -> bool:
    """Return whether our vehicle takes the same command once the session has been proven again."""
    return answer.result == Result.TEMPORARILY_REJECTED and answer.result_param2 == Rejection.NO_PROOF


def _components(waiting: _Waiting) -> tuple[int, ...]:
    """Return the components that get the next try; a stop without an answer goes to all, which 0 means."""
    chosen = (waiting.target[1], *waiting.further)
    return (*chosen, 0) if waiting.stop and waiting.sent and 0 not in chosen else chosen


def _asks_for_other_form(result: int, waiting: _Waiting) -> bool:
    """Return whether a refusal names the form in which the vehicle takes the command, and it was not tried yet."""
    is_int = (waiting.place is not None) != waiting.other_form
    wanted = Result.LONG_ONLY if is_int else Result.INT_ONLY
    return result == wanted and waiting.refused_form is None and _convert(waiting) is not None


def _joint_result(waiting: _Waiting, component: int, result: int) -> int | None:
    """Return the answer of all components together: the first acceptance, else the refusal of the first component.

    None: others have not answered yet, or the refusal is of a form that was a try only, or that is not used any more.
    """
    if result == Result.ACCEPTED:
        return result
    if waiting.stop and waiting.other_form and waiting.refused_form is None:
        return None
    if result == waiting.refused_form:
        return None  # to a frame that was sent before in the form that is not taken: a repeat, or a blind stop
    waiting.answers[component] = result
    asked = {each for each in (waiting.target[1], *waiting.further) if each}
    return waiting.answers.get(waiting.target[1], result) if asked <= waiting.answers.keys() else None


def _convert(waiting: _Waiting, component: int = 0) -> CommandLong | CommandInt | None:
    """Return the command in the other form; None if it has none."""
    message = _first_form(waiting, component)
    return to_command_int(message) if isinstance(message, CommandLong) else to_command_long(message, waiting.sent)


def _message(waiting: _Waiting, component: int) -> Message:
    converted = _convert(waiting, component) if waiting.other_form else None
    return converted or _first_form(waiting, component)


def _first_form(waiting: _Waiting, component: int) -> CommandLong | CommandInt:
    place, command, system = waiting.place, waiting.command, waiting.target[0]
    one, two, three, four, five, six, seven = waiting.params
    if place is None:
        return CommandLong(system, component, command, waiting.sent, one, two, three, four, five, six, seven)
    return CommandInt(system, component, place.frame, command, 0, 0, one, two, three, four, place.x, place.y, seven)
