"""Hooks of the documentation site: files outside docs/ are named, and linked once there is a public repository."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

_LINK = re.compile(r"\[([^\]]*)\]\((\.\./[^)#\s]+|examples[^)#\s]*)(#[^)\s]*)?\)")
ROOT = Path(__file__).parents[1]


def on_page_markdown(markdown: str, *, config: Any, **_: Any) -> str:
    """Return a page whose links to files outside the site are their names, or addresses below `repo_url`."""

    def to_address(match: re.Match[str]) -> str:
        path = (ROOT / "docs" / match[2]).resolve().relative_to(ROOT)
        if config.repo_url:
            return f"[{match[1]}]({config.repo_url.rstrip('/')}/blob/main/{path.as_posix()}{match[3] or ''})"
        return f"{match[1]} (`{path.as_posix()}` of the source)"

    return _LINK.sub(to_address, markdown)
