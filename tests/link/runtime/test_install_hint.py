"""The line that installs an extra works in any shell, for each kind of installation. `make installs` runs the lines."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from link.runtime import install_hint
from link.runtime.install_hint import install_command

ROOT = Path(__file__).parents[3]
PIP = re.compile(r"""["'].*\b(pip|pipx|uvx|uv tool) (install|download|inject|run)\b""")


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of the installation that runs, in which a tool of packages can leave its file."""
    folder = tmp_path / "venvs" / "mavhelm"
    folder.mkdir(parents=True)
    monkeypatch.setattr(sys, "prefix", str(folder))
    return folder


def test_a_venv_names_the_python_that_runs() -> None:
    assert install_command("web") == f"{sys.executable} -m pip install 'mavhelm[web]'"


def test_a_space_in_the_path_is_quoted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/home/me/my rover/bin/python")
    assert install_command("pi") == "'/home/me/my rover/bin/python' -m pip install 'mavhelm[pi]'"


def test_an_environment_without_pip_is_for_uv(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert install_command("ros") == f"uv pip install --python {sys.executable} 'mavhelm[ros]'"


@pytest.mark.parametrize(
    ("requirements", "options", "expected"),
    [
        ('{ name = "mavhelm" }', "", "uv tool install 'mavhelm[web]'"),
        ('{ name = "mavhelm", extras = ["keys"] }', "", "uv tool install 'mavhelm[keys,web]'"),
        ('{ name = "mavhelm", specifier = "<1" }, { name = "numpy" }', "",
         "uv tool install --with numpy 'mavhelm[web]<1'"),
        ('{ name = "mavhelm", path = "/a b/mavhelm.whl" }', "",
         "uv tool install 'mavhelm[web] @ file:///a%20b/mavhelm.whl'"),
        ('{ name = "mavhelm", git = "ssh://host/me?rev=v1" }', "",
         "uv tool install 'mavhelm[web] @ git+ssh://host/me@v1'"),
        ('{ name = "mavhelm" }', 'no-index = true\nfind-links = ["file:///wheels"]',
         "uv tool install --no-index --find-links file:///wheels 'mavhelm[web]'"),
    ],
)  # fmt: skip
def test_a_tool_of_uv_keeps_what_it_had(prefix: Path, requirements: str, options: str, expected: str) -> None:
    receipt = f"[tool]\nrequirements = [{requirements}]\n\n[tool.options]\n{options}\n"
    (prefix / "uv-receipt.toml").write_text(receipt)
    assert install_command("web") == expected


def test_a_tool_of_uv_keeps_its_python(prefix: Path) -> None:
    (prefix / "uv-receipt.toml").write_text('[tool]\nrequirements = [{ name = "mavhelm" }]\npython = "3.12"\n')
    assert install_command("web") == "uv tool install --python 3.12 'mavhelm[web]'"


@pytest.mark.parametrize("damage", ["", "[tool", "\xff"])
def test_a_damaged_receipt_of_uv_still_names_uv(prefix: Path, damage: str) -> None:
    (prefix / "uv-receipt.toml").write_bytes(damage.encode("latin-1"))
    assert install_command("web") == "uv tool install 'mavhelm[web]'"


def test_one_run_of_uvx_is_run_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "prefix", "/home/me/.cache/uv/archive-v0/3GGkIGlq97liPIBO")
    assert install_command("keys") == "uvx 'mavhelm[keys]'"


@pytest.mark.parametrize(
    ("metadata", "expected"),
    [
        ("{}", "pipx inject mavhelm 'mavhelm[web]'"),
        ("[broken", "pipx inject mavhelm 'mavhelm[web]'"),
        ('{"main_package": {"pip_args": ["--no-index", "--find-links", "/a b"]}}',
         "pipx inject --pip-args='--no-index --find-links '\"'\"'/a b'\"'\"'' mavhelm 'mavhelm[web]'"),
    ],
)  # fmt: skip
def test_pipx_injects_with_its_arguments_for_pip(prefix: Path, metadata: str, expected: str) -> None:
    (prefix / "pipx_metadata.json").write_text(metadata)
    assert install_command("web") == expected


def test_one_run_of_pipx_is_run_again(prefix: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached = prefix / ".cache" / "f59d7f6b0c7d58d"
    cached.mkdir(parents=True)
    (cached / "pipx_metadata.json").write_text("{}")
    monkeypatch.setattr(sys, "prefix", str(cached))
    assert install_command("keys") == "pipx run 'mavhelm[keys]'"


@pytest.mark.parametrize(("extra", "package"), [("pi", "python3-lgpio"), ("bags", "python3-numpy")])
def test_the_debian_package_names_debians(extra: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "prefix", str(install_hint.SYSTEM_FOLDER))
    assert install_command(extra) == f"sudo apt install {package}"


def test_each_line_is_words_of_a_shell(prefix: Path) -> None:
    (prefix / "pipx_metadata.json").write_text('{"main_package": {"pip_args": ["--find-links", "/a b"]}}')
    words = shlex.split(install_command("web"))
    assert words[2:] == ["--pip-args=--find-links '/a b'", "mavhelm", "mavhelm[web]"]


def test_no_other_message_of_the_programs_names_pip() -> None:
    """A message with a `pip` of its own would name the system's."""
    sources = (path for folder in ("link", "vehicle", "groundstation") for path in (ROOT / folder).rglob("*.py"))
    own = [path.name for path in sources if any(map(PIP.search, path.read_text().splitlines()))]
    assert own == ["install_hint.py"]
