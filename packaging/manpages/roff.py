"""One manual page from a parser of argparse, in the language man(7)."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

HEADING = re.compile(r"^(\w[^\n]*):(?:\n| )", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Edition:
    """What the foot of each page says."""

    version: str
    date: str
    """As 2026-11-27."""


@dataclass(frozen=True, slots=True)
class Page:
    """What a page is made of."""

    name: str
    """As groundstation-param, without its section."""
    summary: str
    parser: argparse.ArgumentParser
    examples: Sequence[tuple[str, str]] = ()
    """Command, what it does."""
    see_also: Sequence[str] = ()


def escape(text: str) -> str:
    """Return plain text as roff: no character of it is a command."""
    plain = text.replace("\\", r"\e").replace("-", r"\-").replace("'", r"\(aq").replace("`", r"\(ga")
    plain = plain.replace("^", r"\(ha").replace("~", r"\(ti")
    return "\n".join(rf"\&{line}" if line.startswith(".") else line for line in plain.split("\n"))


def build(page: Page, edition: Edition) -> str:
    """Return the source of a page."""
    title = f'.TH {escape(page.name.upper())} 1 {edition.date} "mavhelm {escape(edition.version)}" "User Commands"'
    lines = [title, ".SH NAME", f"{escape(page.name)} \\- {escape(page.summary)}"]
    lines += [".SH SYNOPSIS", *_block(_usage(page.parser))]
    lines += [
        ".SH DESCRIPTION",
        *_paragraphs(page.parser.description or f"{page.summary[0].upper()}{page.summary[1:]}."),
    ]
    lines += _arguments(page.parser)
    lines += _actions(page.parser)
    lines += _epilog(page.parser.epilog or "")
    if page.examples:
        lines.append(".SH EXAMPLES")
        for command, note in page.examples:
            lines += [".TP", f".B {escape(command)}", escape(note)]
    if page.see_also:
        lines += [".SH SEE ALSO", ",\n".join(f".BR {escape(each)} (1)" for each in page.see_also)]
    return "\n".join(lines).replace(",\n.BR", " ,\n.BR") + "\n"


def _usage(parser: argparse.ArgumentParser) -> str:
    """Return the usage: as it is written, or in one line if argparse has made it."""
    usage = parser.format_usage().removeprefix("usage: ").strip()
    return usage if parser.usage else " ".join(usage.split())


def _block(text: str) -> list[str]:
    """Return lines as they are, without filling."""
    return [".nf", escape(text), ".fi"] if "\n" in text else [escape(text)]


def _paragraphs(text: str) -> Iterator[str]:
    for number, paragraph in enumerate(re.split(r"\n\s*\n", text.strip())):
        if number:
            yield ".PP"
        yield escape(" ".join(paragraph.split()))


def _arguments(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Yield the sections of arguments and of options."""
    shown = [each for each in parser._actions if each.help != argparse.SUPPRESS]
    positional = [each for each in shown if not each.option_strings and not _parsers(each)]
    optional = [each for each in shown if each.option_strings]
    for heading, actions in (("ARGUMENTS", positional), ("OPTIONS", optional)):
        if actions:
            yield f".SH {heading}"
            yield from _list(actions, parser)


def _list(actions: Iterable[argparse.Action], parser: argparse.ArgumentParser) -> Iterator[str]:
    formatter = parser._get_formatter()
    for action in actions:
        yield ".TP"
        yield f".B {escape(formatter._format_action_invocation(action))}"
        yield escape(" ".join(formatter._expand_help(action).split())) if action.help else r"\&"


def _parsers(action: argparse.Action) -> dict[str, argparse.ArgumentParser]:
    """Return the parsers of the actions of a verb, as of `param get`, without other words for them."""
    if not isinstance(action, argparse._SubParsersAction):
        return {}
    seen: dict[int, str] = {}
    for name, parser in action.choices.items():
        seen.setdefault(id(parser), name)
    return {name: parser for name, parser in action.choices.items() if seen[id(parser)] == name}


def _actions(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Yield a section for each action."""
    for name, each in (item for action in parser._actions for item in _parsers(action).items()):
        yield f".SH ACTION {escape(name.upper())}"
        yield from _block(_usage(each))
        yield ".PP"
        yield from _paragraphs(each.description or f"{name}.")
        shown = [action for action in each._actions if action.help != argparse.SUPPRESS and not _parsers(action)]
        yield from _list(shown, each)


def _epilog(text: str) -> Iterator[str]:
    """Yield a section for each part of the end of --help, as "exit codes: 0 done" is one."""
    for part in re.split(r"\n\s*\n", text.strip()):
        if not part:
            continue
        heading = HEADING.match(part)
        yield f".SH {escape(heading[1].upper())}" if heading and len(heading[1]) < 40 else ".PP"
        body = part[heading.end() :] if heading and len(heading[1]) < 40 else part
        yield from (".nf", escape(body.rstrip()), ".fi")
