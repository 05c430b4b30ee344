"""Each target with bytes that hypothesis draws, and with the corpus."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.examples import examples
from tests.fuzz.targets import IDS, SERVICES, TARGETS
from tests.rows import each_row

CORPUS = sorted(path for path in (Path(__file__).parent / "corpus").glob("*/*") if path.is_file())
CHUNKS = st.tuples(st.integers(0, 2**16 - 1), st.binary(max_size=60)).map(
    lambda each: each[0].to_bytes(2, "little") + bytes([len(each[1])]) + each[1]
)
BYTES = st.one_of(st.binary(max_size=300), st.lists(CHUNKS, max_size=12).map(b"".join))


@pytest.mark.parametrize("name", TARGETS)
@settings(max_examples=examples(25), suppress_health_check=[HealthCheck.too_slow])
@given(data=BYTES)
def test_nothing_raises(name: str, data: bytes) -> None:
    TARGETS[name](data)


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_the_corpus_raises_nothing(path: Path) -> None:
    TARGETS[path.parent.name](path.read_bytes())


@each_row("number", IDS)
def test_every_message_at_both_ends(number: int) -> None:
    """All fields full, and all fields empty: addressed to us and to nobody."""
    for name, ids in (("vehicle", IDS), ("station", IDS), ("vehicle-services", SERVICES)):
        if number in ids:
            head = ids.index(number).to_bytes(2, "little")
            TARGETS[name](b"".join(head + bytes([255]) + bytes([fill]) * 255 for fill in (0, 1, 0x7F, 0xFF)))
