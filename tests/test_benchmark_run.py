"""A run of benchmarks: what fails does not end it, results are kept as they come, and are written into a document."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.benchmarks import document
from tests.benchmarks.__main__ import main
from tests.benchmarks.figures import BenchmarkError, BenchmarkSkippedError, Goal, Options, Report, Table
from tests.benchmarks.run import Run

PAGE = f"# Page\n\nbefore\n\n{document.BEGIN}\nold figures\n{document.END}\n\nafter\n"


def good(options: Options) -> Report:
    goals = [
        Goal("work of a frame", 2.0, 1.5, "us", reference="pymavlink, 1 us"),
        Goal("frames a second", 12345.678, 10_000, "frames/s", at_least=True),
    ]
    return Report(
        [Table("Frames | bytes", [{"form": "a|b", "us": 1.23456}, {"form": "c", "more": None}], "A note.")], goals
    )


def needs_root(options: Options) -> Report:
    raise BenchmarkSkippedError("namespaces need root")


class Once:
    """Fails until it has been tried so often."""

    def __init__(self, failures: int) -> None:
        self.left = failures

    def __call__(self, options: Options) -> Report:
        self.left -= 1
        if self.left >= 0:
            raise BenchmarkError("the wheels never turned")
        return good(options)


def run_of(**benchmarks: object) -> tuple[Run, list[str]]:
    said: list[str] = []
    return Run(benchmarks, Options(quick=True, tlog=None, say=said.append)), said  # type: ignore[arg-type]


def test_failing_one_does_not_end_the_others_and_is_retried_once() -> None:
    run, said = run_of(late=Once(1), broken=Once(9), rootless=needs_root, good=good)
    run.measure(["late", "broken", "rootless", "good"])
    assert set(run.results["results"]) == {"late", "good"}
    assert run.results["failed"] == {"broken": "the wheels never turned"}
    assert set(run.results["again"]) == {"late", "broken"}
    assert run.results["skipped"] == {"rootless": "namespaces need root"}
    assert "rootless is left out: namespaces need root" in said


def test_results_are_in_file_before_the_next_benchmark_begins(tmp_path: Path) -> None:
    out, seen = tmp_path / "run.json", list[list[str]]()

    def look(options: Options) -> Report:
        seen.append(list(json.loads(out.read_text())["results"]))
        return good(options)

    options = Options(quick=True, tlog=None, say=lambda line: None)
    Run({"first": good, "second": look}, options, out).measure(["first", "second"])
    assert seen == [["first"]]
    assert list(json.loads(out.read_text())["results"]) == ["first", "second"]


def test_the_results_of_a_file_replace_those_between_the_marks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, page = tmp_path / "run.json", tmp_path / "page.md"
    options = Options(quick=True, tlog=None, say=lambda line: None)
    Run({"good": good, "rootless": needs_root}, options, out).measure(["good", "rootless"])
    page.write_text(PAGE)
    for _ in range(2):  # the second time replaces what the first one wrote
        capsys.readouterr()
        assert main(["--from", str(out), "--into", str(page), "--markdown"]) == 0
    text = page.read_text()
    assert text.startswith("# Page\n\nbefore\n\n")
    assert text.endswith("\n\nafter\n")
    assert "old figures" not in text
    assert "| `good` | work of a frame | pymavlink, 1 us | 2 us | <= 1.5 us | **no** |" in text
    assert "|  | frames a second | - | 12,300 frames/s | >= 10000 frames/s | yes |" in text
    assert "1 of 2 goals are met" in text
    assert "Left out: `rootless`, namespaces need root." in text
    assert "| a\\|b | 1.23 | - |" in text  # columns of all rows, in each row
    assert capsys.readouterr().out.strip() in text


@pytest.mark.parametrize("page", ["no marks\n", PAGE + PAGE, PAGE.replace(document.END, "")])
def test_a_document_without_the_marks_is_left_as_it_is(page: str, tmp_path: Path) -> None:
    file = tmp_path / "page.md"
    file.write_text(page)
    with pytest.raises(BenchmarkError, match=r"page\.md: expected the lines"):
        document.replace(file, "new")
    assert file.read_text() == page


def test_a_file_that_is_no_run_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "run.json"
    for content in ("{", "{}"):
        file.write_text(content)
        assert main(["--from", str(file), "--markdown"]) == 2
        assert "run.json" in capsys.readouterr().err
    assert main(["--from", str(tmp_path / "none.json")]) == 2


def test_the_page_of_the_figures_has_the_marks() -> None:
    page = (Path(__file__).parents[1] / "docs" / "performance.md").read_text()
    assert page.count(document.BEGIN) == page.count(document.END) == 1


def test_a_goal_that_is_missed_is_linked_to_what_is_in_its_way() -> None:
    report = Report([], [Goal("vehicle, CPU driving", 3.0, 2.0, "%"), Goal("work of a frame", 2.0, 1.5, "us")])
    run, _ = run_of(cost=lambda options: report)
    run.measure(["cost"])
    lines = document.results(run.results).splitlines()
    assert "| `cost` | vehicle, CPU driving | - | 3 % | <= 2 % | **no**, [why](#cpu-of-vehicle-and-station) |" in lines
    assert "|  | work of a frame | - | 2 us | <= 1.5 us | **no** |" in lines


def test_what_is_in_the_way_stands_in_the_document() -> None:
    page = Path("docs/performance.md").read_text()
    assert [heading for *_, heading in document.REASONS if f"# {heading}\n" not in page] == []
    assert document.anchor("The path of a demand, the framer") == "the-path-of-a-demand-the-framer"
