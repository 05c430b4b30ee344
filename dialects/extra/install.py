"""Adds the messages and enum names of a user's dialect to those that this process knows.

A message that is built in with the same definition stays as it is. One with another definition is replaced, because
the user says what the vehicle sends, unless the programs themselves read it: then the built-in one stays, and a note
says so. Starting without the other messages of the file would help nobody.
"""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256

from dialects import codec, messages, targets
from dialects.enum_names import add_enum_names, enum_names
from dialects.enums import Severity
from dialects.extra.definitions import ExtraDefinition, Field
from dialects.extra.dialect import Dialect
from dialects.extra.errors import DialectError
from dialects.extra.message_class import make_class, make_decoder, make_encoder
from dialects.extra.notes import Note

NAMES_MAX = 5
"""Names of messages in one note."""


def install(dialect: Dialect, file: str) -> tuple[Note, ...]:
    """Add a dialect read from `file`; return what to tell the user. Raises DialectError; nothing is changed then."""
    _check_enums(dialect)
    read = messages.read_by_programs()
    added: list[ExtraDefinition] = []
    replaced: list[ExtraDefinition] = []
    kept: list[ExtraDefinition] = []
    for each in dialect.messages:
        built_in = messages.MESSAGES.get(each.id)
        if built_in is None:
            added.append(each)
        elif (built_in.msgname, built_in.crc_extra) != (each.name, each.crc_extra):
            (kept if each.id in read else replaced).append(each)
    for each in (*added, *replaced):
        _register(each, dialect)
    for enum in dialect.enums.values():
        add_enum_names(enum.name, enum.names)
    return (
        Note(f"dialect {file}: {len(dialect.messages)} messages, {len(added)} of them added{_names(added)}"),
        *([Note(f"dialect {file} replaces built-in definitions{_names(replaced)}")] if replaced else []),
        *(Note(_why_kept(each), Severity.WARNING) for each in kept),
    )


def fingerprint(dialect: Dialect) -> str:
    """Return what is the same for files with the same messages and enums, wherever they are."""
    messages_of = sorted((each.id, each.name, each.crc_extra) for each in dialect.messages)
    enums = sorted((enum.name, sorted(enum.names.items())) for enum in dialect.enums.values())
    return sha256(repr((messages_of, enums)).encode()).hexdigest()


def _register(definition: ExtraDefinition, dialect: Dialect) -> None:
    message = make_class(definition, dialect.enums)
    decoder, encoder = make_decoder(message, definition), make_encoder(message, definition)
    codec.register(message, definition.base_size, decoder, encoder)
    targets.register(message)


def _check_enums(dialect: Dialect) -> None:
    for message in dialect.messages:
        for each in _fields(message):
            if each.enum and each.enum not in dialect.enums and not enum_names(each.enum):
                raise DialectError(
                    f"{each.place}: field {each.name}: no enum {each.enum[:80]!a}: include the file that has it"
                )


def _fields(message: ExtraDefinition) -> Iterable[Field]:
    return (*message.fields, *message.extensions)


def _names(found: list[ExtraDefinition]) -> str:
    if not found:
        return ""
    names = ", ".join(each.name for each in found[:NAMES_MAX])
    return f": {names}{', ...' if len(found) > NAMES_MAX else ''}"


def _why_kept(message: ExtraDefinition) -> str:
    built_in = messages.MESSAGES[message.id]
    return (
        f"{message.place}: {message.name} (id {message.id}) is not the built-in {built_in.msgname}, which this program "
        "needs and keeps: messages of the other definition are dropped"
    )
