"""Workflows, issue forms and the citation can be read, and name programs, targets and files that exist."""

from __future__ import annotations

import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[1]
GITHUB = ROOT / ".github"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
WORKFLOWS = sorted((GITHUB / "workflows").glob("*.yml"))
FORMS = sorted(path for path in (GITHUB / "ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml")


def parse(path: Path) -> Any:
    return YAML(typ="safe").load(path.read_text())


def jobs(workflow: Path) -> dict[str, Any]:
    found: dict[str, Any] = parse(workflow)["jobs"]
    return found


def lines(workflow: Path) -> Iterator[list[str]]:
    """Yield the commands of a workflow as words."""
    for job in jobs(workflow).values():
        for step in job["steps"]:
            yield from (shlex.split(line) for line in step.get("run", "").splitlines())


def missing(words: list[str]) -> list[str]:
    """Return what a command names and the checkout does not have."""
    targets = re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    extras = {extra for each in re.findall(r"\.\[(.*)\]", " ".join(words)) for extra in each.split(",")}
    wrong = [word for word in words[1:] if words[0] == "make" and word not in targets]
    wrong += [word for word in words if word.startswith((".ci/", "tests/")) and not (ROOT / word).exists()]
    return wrong + sorted(extras - PROJECT["optional-dependencies"].keys())


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_commands_of_a_workflow_name_what_exists(workflow: Path) -> None:
    commands = list(lines(workflow))
    assert commands
    assert [wrong for words in commands for wrong in missing(words)] == []


def test_a_command_that_names_nothing_is_found() -> None:
    assert missing(["make", "sure"]) == ["sure"]
    assert missing([".ci/gone"]) == [".ci/gone"]
    assert missing(["pip", "install", ".[web,nothing]"]) == ["nothing"]


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_may_only_read_where_no_job_says_more(workflow: Path) -> None:
    assert parse(workflow)["permissions"] == {"contents": "read"}
    assert [name for name, job in jobs(workflow).items() if "timeout-minutes" not in job] == []


def test_a_push_runs_what_a_developer_runs() -> None:
    ci = parse(GITHUB / "workflows/ci.yml")
    assert {"push", "pull_request"} <= ci["on"].keys()
    assert [".ci/run"] in list(lines(GITHUB / "workflows/ci.yml"))
    pythons = [each.rpartition(" ")[2] for each in PROJECT["classifiers"] if ":: Python :: 3." in each]
    assert ci["jobs"]["python"]["strategy"]["matrix"]["python"] == pythons


def test_a_release_is_attested_and_published_without_a_password() -> None:
    release = jobs(GITHUB / "workflows/release.yml")
    uses = {name: [step.get("uses", "").partition("@")[0] for step in job["steps"]] for name, job in release.items()}
    assert "actions/attest-build-provenance" in uses["build"]
    assert "pypa/gh-action-pypi-publish" in uses["index"]
    assert release["index"]["permissions"] == {"id-token": "write"}
    assert release["index"]["environment"] == "release"
    assert "secrets." not in (GITHUB / "workflows/release.yml").read_text()


@pytest.mark.parametrize("form", FORMS, ids=lambda path: path.stem)
def test_an_issue_form_has_what_the_platform_requires(form: Path) -> None:
    contents = parse(form)
    assert {"name", "description", "body"} <= contents.keys()
    kinds = {"markdown", "textarea", "input", "dropdown", "checkboxes"}
    assert {each["type"] for each in contents["body"]} <= kinds
    asked = [each for each in contents["body"] if each["type"] != "markdown"]
    assert all(each["attributes"]["label"] for each in asked)
    assert len({each["id"] for each in asked}) == len(asked)


def test_a_bug_comes_with_the_report_of_doctor() -> None:
    from groundstation.verbs.table import VERBS

    [report] = [each for each in parse(GITHUB / "ISSUE_TEMPLATE/bug.yml")["body"] if each.get("id") == "report"]
    assert "doctor --report" in report["attributes"]["description"]
    assert report["validations"] == {"required": True}
    [action] = VERBS["doctor"].actions.values()
    assert "--report" in [name for name, _ in action.arguments]


def test_dependabot_watches_the_folders_with_versions() -> None:
    updates = {each["package-ecosystem"]: each["directory"] for each in parse(GITHUB / "dependabot.yml")["updates"]}
    assert updates == {"pip": "/", "github-actions": "/"}


def test_the_citation_is_of_the_version_and_its_release_date() -> None:
    citation = parse(ROOT / "CITATION.cff")
    assert citation["version"] == PROJECT["version"]
    assert citation["license"] == PROJECT["license"]
    dates = re.findall(rf"^## {re.escape(PROJECT['version'])} \((.*)\)$", (ROOT / "CHANGELOG.md").read_text(), re.M)
    assert dates == [str(citation["date-released"])]
