"""The short suite: its tables name what exists, and it and the rest are all tests, each once. Test names are short."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests import suite
from tests.rows import each_row


@each_row("row", [*suite.LONG, *suite.MAIN_JOB, *suite.MARKED])
def test_a_row_names_a_folder_a_file_or_a_test(row: str) -> None:
    path, _, test = row.partition("::")
    place = suite.TESTS / path
    assert place.exists()
    assert not test or f"def {test.partition('[')[0]}" in place.read_text()


def test_short_and_rest_are_all_tests_each_once(request: pytest.FixtureRequest) -> None:
    items = request.session.items
    short, others = suite.split(items, suite.SHORT)
    assert suite.split(items, suite.REST) == (others, short)
    assert sorted(map(id, [*short, *others])) == sorted(map(id, items))
    assert suite.split(items, suite.ALL) == (items, [])


def test_a_few_rows_of_a_long_table_are_in_the_short_suite(request: pytest.FixtureRequest) -> None:
    rows = [item for item in request.session.items if "::test_files_without_a_short_test" in item.nodeid]
    assert len(rows) > 10
    assert len(suite.thinned(rows)) == suite.ROWS
    assert suite.thinned(rows[:1]) == rows[:1]


@pytest.mark.parametrize(
    ("path", "is_long"),
    [
        ("e2e", False), ("e2e/test_stop_matrix.py", False), ("e2e/test_browser.py", True), ("interop", True),
        ("recipes", True), ("recipes/test_key.py", True), ("vehicle/drive/test_gate.py", False),
        ("groundstation/verbs", False), ("groundstation/verbs/line", False),
        ("groundstation/verbs/line/test_parser.py", False), ("groundstation/verbs/files/test_param.py", True),
        ("vehicle/sensors/test_gps.py", False),
    ],
)  # fmt: skip
def test_files_without_a_short_test_are_not_imported(path: str, is_long: bool) -> None:
    assert suite.is_long_file(suite.TESTS / path) == is_long


MAX_NAME = 60
"""Characters in the name of a test: one line of pytest's report, one short sentence."""


def defined_tests(path: Path) -> list[str]:
    """Return the names of the tests that a file defines, with their class: `Class.test_name`."""
    bodies: list[tuple[str, ast.AST]] = [("", ast.parse(path.read_text()))]
    names = []
    for prefix, body in bodies:
        for node in ast.iter_child_nodes(body):
            if isinstance(node, ast.ClassDef):
                bodies.append((f"{prefix}{node.name}.", node))
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name.startswith("test_"):
                names.append(prefix + node.name)
    return names


def test_no_name_of_a_test_is_long_or_given_twice_in_a_module() -> None:
    files = [path for path in suite.TESTS.rglob("*.py") if "def test_" in path.read_text()]
    assert len(files) > 500
    wrong = []
    for path in files:
        for name, count in Counter(defined_tests(path)).items():
            if count > 1:
                wrong.append(f"{path}: {name} is defined {count} times, and only the last one runs")
            if len(name.rpartition(".")[2]) > MAX_NAME:
                wrong.append(f"{path}: {name} is longer than {MAX_NAME} characters")
    assert not wrong, "\n".join(wrong)


CONFTEST = """
from tests import suite
def pytest_addoption(parser): parser.addoption("--suite")
def pytest_report_header(config): return f"suite: {suite.chosen(config)}"
"""


@pytest.mark.parametrize(("words", "expected"), [((), "short"), (("--suite=rest",), "rest"), (("test_one.py",), "all")])
def test_pytest_alone_runs_the_short_suite_and_named_files_whole(
    tmp_path: Path, words: tuple[str, ...], expected: str
) -> None:
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "pytest.ini").write_text(f"[pytest]\ntestpaths = .\npythonpath = {suite.TESTS.parent}\n")
    (tmp_path / "test_one.py").write_text("def test_one(): pass\n")
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=100, check=True)
    assert f"suite: {expected}\n" in done.stdout
