"""Every file, test, parameter and command that the docs name exists."""

from __future__ import annotations

import ast
import functools
import re
import shlex
from importlib import import_module
from pathlib import Path

from groundstation.cli import options as station_options
from groundstation.cli.local import attach, completion, config, keys, learn, replay, serve, video
from groundstation.cli.verb_help import LOCAL_VERBS
from groundstation.verbs import main as verbs_main
from groundstation.verbs.table import VERBS
from link.bridge import __main__ as bridge_main
from tests.prose import find_faults, split_sentences
from tests.recipes.tree import documented_counts
from tests.rows import each_row
from vehicle.cli import options, subcommands
from vehicle.params import PARAMETERS

ROOT = Path(__file__).parents[1]
PACKAGES = ("dialects", "link", "vehicle", "groundstation")
DOCS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
ROOMS = sorted(
    path
    for package in PACKAGES
    for path in (ROOT / package).rglob("__init__.py")
    if "To add or change:" in path.read_text()
)
"""Rooms whose docstring says where things are added."""
FOLDERS = ("dialects", "link", "vehicle", "groundstation", "tests", "docs", ".ci")


def path_of(doc: Path) -> str:
    """Return the path of a document in the project."""
    return doc.relative_to(ROOT).as_posix()


def quoted(text: str) -> list[str]:
    """Return the texts between backticks, outside code blocks."""
    return re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL))


@functools.cache
def functions(path: Path) -> set[str]:
    """Return the functions in a file as pytest takes them after the path: `name`, or `Class::name`."""
    body = ast.parse(path.read_text()).body
    inside = [("", body), *((f"{node.name}::", node.body) for node in body if isinstance(node, ast.ClassDef))]
    return {
        before + node.name
        for before, nodes in inside
        for node in nodes
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }


@each_row("doc", [*DOCS, *ROOMS], ids=path_of)
def test_files_and_tests_that_a_document_names_exist(doc: Path) -> None:
    for words in quoted(doc.read_text()):
        name, _, test = words.partition("::")
        if name.split("/")[0] not in FOLDERS or "/" not in name or " " in name or "*" in name:
            continue
        assert (ROOT / name).exists(), f"{doc.name} names {name}"
        if test:
            assert test in functions(ROOT / name), f"{doc.name} names {words}"


@each_row("doc", DOCS, ids=lambda path: path.name)
def test_links_between_documents_lead_somewhere(doc: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", doc.read_text()):
        assert (doc.parent / target).exists(), f"{doc.name} links to {target}"


def anchors(doc: Path) -> set[str]:
    """Return the anchors of the headings of a document, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", doc.read_text(), flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@each_row("doc", DOCS, ids=path_of)
def test_links_to_headings_lead_to_one(doc: Path) -> None:
    for name, anchor in re.findall(r"\]\(([^)#:]*)#([^)]+)\)", doc.read_text()):
        assert anchor in anchors(doc.parent / name if name else doc), f"{doc.name} links to {name}#{anchor}"


def test_parameters_in_the_safety_document_have_their_defaults() -> None:
    text = (ROOT / "docs/safety.md").read_text()
    named = re.findall(r"\b([A-Z]+(?:_[A-Z0-9]+)+) (\d+(?:\.\d+)?) s", text)
    assert len(named) >= 6
    for name, value in named:
        assert PARAMETERS[name].default == float(value), name


COMMANDS = re.compile(r"(?:^|(?<!-[In])\s|bin/)mavhelm( vehicle| bridge)?((?: [^#|&;]*)?)(?:[#|&;]|$)")
"""`mavhelm` in a line of a shell block: the program that its first word names, and the arguments."""


def commands(text: str) -> list[tuple[str, list[str]]]:
    """Return our commands in the shell blocks of a document."""
    lines = [line for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    found = [match for line in lines if (match := COMMANDS.search(line.partition(" #")[0]))]
    return [((match[1] or "").strip(), shlex.split(match[2].replace("$word", "reboot"))) for match in found]


LOCAL_PARSERS = {
    "config": config.build_parser,
    "keys": keys.build_parser,
    "attach": attach.build_parser,
    "serve": serve.build_parser,
    "completion": completion.build_parser,
    "learn": learn.build_parser,
    "replay": replay.build_replay_parser,
    "video": video.build_parser,
}

SHOWN = [(doc.name, program, words) for doc in DOCS for program, words in commands(doc.read_text())]


@each_row(("doc", "program", "words"), SHOWN, ids=lambda value: str(value))
def test_a_command_that_a_document_shows_is_understood(doc: str, program: str, words: list[str]) -> None:
    if program == "vehicle" and words[0] in subcommands.SUBCOMMANDS:
        subcommands.build_parser(words[0]).parse_args(words[1:])
    elif program == "vehicle":
        options.build_parser().parse_intermixed_args(options.join_home_option(words))
    elif not program and words and words[0] in VERBS:
        verbs_main.build_parser(words[0]).parse_args(words[1:])
    elif not program and words and words[0] in LOCAL_VERBS:
        LOCAL_PARSERS[words[0]]().parse_args(words[1:])
    elif not program:
        station_options.build_parser()[0].parse_args(words)
    elif words and words[0] in bridge_main.SUBCOMMANDS:
        import_module(bridge_main.SUBCOMMANDS[words[0]]).build_parser().parse_args(words[1:])
    else:
        bridge_main.build_parser().parse_args(words)


def test_commands_are_found_in_the_documents() -> None:
    found = {(doc, program) for doc, program, _ in SHOWN}
    assert {("pi.md", "vehicle"), ("bridge.md", "bridge"), ("README.md", "")} <= found
    assert {words[0] for doc, _, words in SHOWN if doc == "pi.md"} >= {"init", "check", "motor-test", "systemd-unit"}


README_COMMAND = "&& pytest -n auto --dist loadgroup\n"


def test_ci_types_the_lines_of_the_readme_and_runs_the_rest() -> None:
    assert README_COMMAND in (ROOT / "README.md").read_text()
    lines = (ROOT / ".ci/run").read_text().splitlines()
    assert any(line.startswith("python3 -m tests.stranger --no-skips ") for line in lines)
    rest = "--dist loadgroup --suite rest"
    assert f"MAVHELM_EXAMPLES=$few_examples .venv/bin/pytest -n 5 {rest} --kind waiting || rest=1" in lines
    assert any(line.startswith(f'    .venv/bin/pytest -n "$(nproc)" {rest} --kind computing ') for line in lines)
    assert any(line.startswith("wait $computing || { rest=1;") for line in lines)
    assert "((rest == 0)) || .venv/bin/python .ci/again || code=1" in lines


def test_make_runs_the_test_command_of_the_readme() -> None:
    makefile = (ROOT / "Makefile").read_text()
    assert "\t$(PYTEST) $(PARALLEL)\n" in makefile
    assert "\t$(PYTEST) $(PARALLEL) --suite all\n" in makefile
    assert "PARALLEL = -n auto --dist loadgroup\n" in makefile


def test_every_recipe_of_contributing_is_followed_by_a_test() -> None:
    tests = "".join(path.read_text() for path in (ROOT / "tests/recipes").glob("test_*.py"))
    assert len(documented_counts()) == 13
    assert [name for name in documented_counts() if f'check_recipe("{name}")' not in tests] == []


@each_row("doc", DOCS, ids=path_of)
def test_prose_of_a_document_is_within_its_limits(doc: Path) -> None:
    assert find_faults(doc.read_text()) == []


def test_limits_of_prose_find_each_kind_of_fault() -> None:
    words = "word " * 19
    document = (
        f"# Title\n\n{words}ends. Here `a b c` [is](x.md) one.\n\n{words}{words} {words}ends.\n\n"
        f"- {words}one. And {words}two.\n- {words}one.\n  Goes on.\n\n```sh\n{words * 9}\n```\n\n"
        f"| a | {'b' * 121} |\n|---|---|\n\n{' '.join(['Five words are in here.'] * 17)}\n"
    )
    assert find_faults(document) == [
        "5: a sentence of 58 words",
        "15: a cell of 121 characters",
        "18: a paragraph of 85 words",
    ]
    assert "one sentence in ten has 26 words or more" in find_faults(f"{words}word word word word word word ends.")
    assert split_sentences("It is 0.5 s, e.g. here. `x` ends (so). Then 3 more.") == [
        "It is 0.5 s, e.g here.",
        "\0 ends (so).",
        "Then 3 more.",
    ]


def test_index_of_the_documents_names_each_page() -> None:
    index = ROOT / "docs/README.md"
    named = set(re.findall(r"^\| \[([\w-]+\.md)\]", index.read_text(), re.MULTILINE))
    assert named == {page.name for page in index.parent.glob("*.md")} - {"README.md"}
