"""A vehicle that answers commands, for the tests of the command protocol."""

from __future__ import annotations

from dialects.enums import Command, Result
from dialects.messages import CommandAck, CommandLong, Message
from link.core import Peer, Received
from link.services.command.request import CommandRequest
from link.services.command.server import CommandHandler, CommandServer

PEER = Peer(0, "there")


def received(message: Message, system: int = 255, component: int = 190) -> Received:
    return Received(message, system, component, 0, PEER, introduced=True)


def long(
    command: int, param1: float = 0.0, *, system: int = 1, component: int = 1, confirmation: int = 0
) -> CommandLong:
    return CommandLong(system, component, command, confirmation, param1, 0, 0, 0, 5, 6, 7)


class CommandRig:
    """A server that notes what it ran."""

    def __init__(self, result: Result = Result.ACCEPTED) -> None:
        self.ran: list[CommandRequest] = []
        self.result = result
        self.server = CommandServer(
            {
                Command.COMPONENT_ARM_DISARM: CommandHandler(self.run),
                Command.DO_FLIGHTTERMINATION: CommandHandler(self.run, broadcast=True),
            },
            system=1,
            component=1,
        )

    def run(self, request: CommandRequest, now: float) -> Result:
        self.ran.append(request)
        return self.result

    def ask(self, message: Message, now: float = 0.0, system: int = 255) -> list[CommandAck]:
        answers = [each.message for each in self.server.receive(received(message, system), now)]
        assert all(isinstance(each, CommandAck) for each in answers)
        return answers  # type: ignore[return-value]
