"""A copy of the tree for each recipe."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.recipes.tree import Tree


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    """Copy the packages into a scratch folder."""
    return Tree(tmp_path)
