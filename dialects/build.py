"""Build hook: generates dialects/rover.py from rover.xml when the project is built, never at run time.

rover.xml includes the definitions of the installed pymavlink; extension fields that those lack are in additions.xml.

dialects/rover.py is the module that pymavlink's mavgen writes, without what the project does not read at run time,
followed by code from this file: two flat functions per message (payload bytes <-> fields) and MAVLink 1's payload
lengths. mavgen's own decode() interprets the definitions at run time, five times slower. What mavgen's constructors
store in each message (a header, its name, ten values more) is stored once in its class: a message costs half.
"""

from __future__ import annotations

import contextlib
import io
import py_compile
import re
import runpy
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pymavlink
from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from pymavlink.generator import mavgen, mavparse

HERE = Path(__file__).resolve().parent
XML = HERE / "rover.xml"
ADDITIONS = HERE / "additions.xml"
MODULE = HERE / "rover.py"
INCLUDES = ("minimal.xml", "standard.xml", "common.xml")
TEXTS = ("description", "param", "field")
"""Elements whose text is only documentation."""
NAMED = ("MAV_CMD", "MAV_RESULT")
"""Enums whose names are kept; of the others only the numbers are."""
_STORED_IN_CLASS = re.compile(
    r"        (MAVLink_message\.__init__\(self, MAVLink_\w+\.id, MAVLink_\w+\.msgname\)"
    r"|self\.(_fieldnames|_instance_field|_instance_offset) = MAVLink_\w+_message\.\w+)"
)
"""Lines of a message's constructor that are the same for all messages of a class."""
_CLASS_ATTRIBUTES = """
class _NewHeader:
    def __get__(self, message, owner):
        return MAVLink_header(owner.id)


MAVLink_message._header = _NewHeader()
MAVLink_message._payload = MAVLink_message._crc = MAVLink_message._link_id = MAVLink_message._instances = None
MAVLink_message._signed, MAVLink_message._msgbuf = False, b""
for _each in mavlink_map.values():
    _each._type, _each._fieldnames = _each.msgname, _each.fieldnames
    _each._instance_field, _each._instance_offset = _each.instance_field, _each.instance_offset
"""
"""A message that was neither sent nor received has a header with its id alone, made when pymavlink asks for it."""


def generate(target: Path = MODULE) -> Path:
    """Write the message module to `target` and its byte code beside it; return the byte code's path.

    The byte code is validated by the source's hash and not its time, so that it stays valid inside a wheel. Without
    it a read-only installation would compile 2 MB of Python at each start (0.5 s and 70 MB more). It names the module
    without its folder, so that two builds are the same: Python writes the real path into what it has read.
    """
    with tempfile.TemporaryDirectory() as scratch, _quiet():
        module = generate_plain(Path(scratch))
        messages = _messages(Path(scratch))
        made_from = runpy.run_path(str(HERE / "fingerprint.py"))["line"]()
        code = "\n".join([strip_unused(module.read_text("utf-8")), *_codec(messages), made_from]) + "\n"
    whole = target.with_suffix(".new")
    whole.write_text(code, "utf-8")
    whole.replace(target)  # a program that starts meanwhile reads the old module or the new one, never a part
    checked = py_compile.PycInvalidationMode.CHECKED_HASH
    return Path(str(py_compile.compile(str(target), dfile=target.name, doraise=True, invalidation_mode=checked)))


def generate_plain(folder: Path) -> Path:
    """Write the module as mavgen makes it, and the definitions that it is made of, to `folder`; return its path."""
    installed = Path(pymavlink.__file__).parent / "dialects" / "v20"
    definitions = [folder / name for name in INCLUDES]
    for each in definitions:
        shutil.copy(installed / each.name, each)
    add_fields(ADDITIONS, definitions)
    xml = Path(shutil.copy(XML, folder))
    drop_texts([xml, *definitions])
    module = folder / MODULE.name
    _mavgen(xml, module)
    return module


def add_fields(additions: Path, definitions: Sequence[Path]) -> None:
    """Add the extension fields of `additions` to the messages of `definitions`, which are rewritten.

    Raises ValueError for a message that none of them has, and for a field that exists already: then the installed
    definitions are newer than the list.
    """
    trees = {path: ElementTree.parse(path) for path in definitions}
    messages = {each.get("name"): each for tree in trees.values() for each in tree.iter("message")}
    for wanted in ElementTree.parse(additions).iter("message"):
        name = wanted.get("name")
        if name not in messages:
            raise ValueError(f"{additions.name}: there is no message {name}")
        _extend(messages[name], list(wanted.iter("field")), additions.name)
    for path, tree in trees.items():
        tree.write(path, "utf-8", xml_declaration=True)


def _extend(message: ElementTree.Element, fields: list[ElementTree.Element], source: str) -> None:
    there = {each.get("name") for each in message.iter("field")}
    twice = sorted(there & {each.get("name") for each in fields}, key=str)
    if twice:
        raise ValueError(f"{source}: {message.get('name')} has {twice[0]} already, delete it from the list")
    if message.find("extensions") is None:
        ElementTree.SubElement(message, "extensions")
    message.extend(fields)


def drop_texts(definitions: Sequence[Path]) -> None:
    """Remove the documentation texts in `definitions`, which mavgen would copy into the module."""
    for path in definitions:
        tree = ElementTree.parse(path)
        for name in TEXTS:
            for element in tree.iter(name):
                element.text = ""
        tree.write(path, "utf-8")


def strip_unused(code: str) -> str:
    """Return mavgen's module without enum tables (except names of NAMED) and two methods of each message.

    The methods build and send a message through mavgen's MAVLink class. With them and the documentation texts, each
    process that imports the module takes 1.6 MiB more. Of the constructors the lines of _STORED_IN_CLASS are left out.
    """
    named = re.compile(rf'enums\["({"|".join(NAMED)})"\](\[\d+\])? = ')
    method = re.compile(r"    def \w+_(encode|send)\(self, ")
    kept: list[str] = []
    inside = False
    """Inside one of those methods."""
    for line in code.splitlines():
        if line.strip() and not line.startswith("     "):  # not a method's body
            inside = method.match(line) is not None
        if inside or _STORED_IN_CLASS.fullmatch(line):
            continue
        if not line.startswith("enums[") or named.match(line):
            kept.append(line)
    return "\n".join(kept)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Hide mavgen's output unless it fails."""
    chatter = io.StringIO()
    try:
        with contextlib.redirect_stdout(chatter), contextlib.redirect_stderr(chatter):
            yield
    except BaseException:
        sys.stderr.write(chatter.getvalue())
        raise


def _mavgen(xml: Path, output: Path) -> None:
    options = mavgen.Opts(
        str(output), wire_protocol=mavparse.PROTOCOL_2_0, language="Python3", validate=True, strict_units=True
    )
    if not mavgen.mavgen(options, [str(xml)]):
        raise RuntimeError(f"mavgen refused {XML}; it says why above")


def _messages(folder: Path) -> list[Any]:
    """Return the parsed messages of the dialect and its includes, by id."""
    parsed: list[Any] = []
    for name in (*INCLUDES, XML.name):
        parsed += mavparse.MAVXML(str(folder / name), mavparse.PROTOCOL_2_0).message
    return sorted(parsed, key=lambda message: int(message.id))


def _codec(messages: list[Any]) -> Iterator[str]:
    """Yield source lines: _decode_N and _encode_N for each message id N, and the tables of them."""
    yield "\n# ---- written by dialects/build.py ----\n"
    yield _CLASS_ATTRIBUTES
    yield "_new = object.__new__"
    for message in messages:
        yield from _decoder(message)
        yield from _encoder(message)
    for table, value in (("DECODERS", "_decode_{0}"), ("ENCODERS", "_encode_{0}")):
        yield f"{table} = {{" + ", ".join(f"{m.id}: " + value.format(m.id) for m in messages) + "}"
    yield "BASE_SIZES = {" + ", ".join(f"{m.id}: {m.wire_min_length}" for m in messages) + "}"


def _class(message: Any) -> str:
    return f"MAVLink_{message.name_lower}_message"


def _decoder(message: Any) -> Iterator[str]:
    cls, fields = _class(message), message.ordered_fields
    yield f"def _decode_{message.id}(payload, _unpack={cls}.unpacker.unpack):"
    if any(field.type == "char" for field in fields):  # the class stores text twice
        yield "    v = _unpack(payload)"
        yield f"    return {cls}(" + ", ".join(f"{name}={value}" for name, value in _slices(fields)) + ")"
        return
    yield f"    m = _new({cls})"
    if any(field.array_length for field in fields) or len(fields) == 1:
        yield "    v = _unpack(payload)"
        yield from (f"    m.{name} = {value}" for name, value in _slices(fields))
    else:
        yield "    " + ", ".join(f"m.{field.name}" for field in fields) + " = _unpack(payload)"
    yield "    return m"


def _slices(fields: list[Any]) -> Iterator[tuple[str, str]]:
    """Yield where each field lies in the unpacked tuple.

    A char array is one item there, another array has one item per element.
    """
    at = 0
    for field in fields:
        if field.type == "char":
            yield field.name, f'v[{at}].rstrip(b"\\0")'
            at += 1
        elif field.array_length:
            yield field.name, f"list(v[{at}:{at + field.array_length}])"
            at += field.array_length
        else:
            yield field.name, f"v[{at}]"
            at += 1


def _encoder(message: Any) -> Iterator[str]:
    values = []
    for field in message.ordered_fields:
        if field.type == "char":
            values.append(f"m._{field.name}_raw")
        else:
            values.append(f"*m.{field.name}" if field.array_length else f"m.{field.name}")
    yield f"def _encode_{message.id}(m, _pack={_class(message)}.unpacker.pack):"
    yield f"    return _pack({', '.join(values)})"


class DialectBuildHook(BuildHookInterface[Any]):
    """Generates the message module for wheels and editable installs."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Generate the module, and add it to a wheel."""
        byte_code = generate()
        if version != "editable":
            build_data["force_include"][str(MODULE)] = "dialects/rover.py"
            build_data["force_include"][str(byte_code)] = f"dialects/__pycache__/{byte_code.name}"
