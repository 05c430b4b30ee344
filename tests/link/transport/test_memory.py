"""The lossy pipe that other tests stand on."""

from __future__ import annotations

from link.transport.memory import LossyPipe


def test_a_plain_pipe_delivers_in_order_at_once() -> None:
    pipe = LossyPipe[bytes]()
    pipe.send(b"1", 0.0)
    pipe.send(b"2", 0.0)
    assert pipe.receive(0.0) == [b"1", b"2"]
    assert pipe.receive(1.0) == []


def test_delay_and_jitter_keep_the_order() -> None:
    pipe = LossyPipe[bytes](delay=0.1, jitter=0.09, seed=4)
    for number in range(100):
        pipe.send(bytes([number]), number * 0.001)
    assert pipe.receive(0.009) == []
    assert b"".join(pipe.receive(1.0)) == bytes(range(100))


def test_loss_is_about_what_was_asked_for_and_repeatable() -> None:
    def survivors(seed: int) -> list[bytes]:
        pipe = LossyPipe[bytes](loss=0.3, seed=seed)
        for number in range(1000):
            pipe.send(number.to_bytes(2, "big"), 0.0)
        return pipe.receive(0.0)

    assert 650 < len(survivors(1)) < 750
    assert survivors(1) == survivors(1)
    assert survivors(1) != survivors(2)


def test_a_cut_loses_what_is_under_way() -> None:
    pipe = LossyPipe[bytes](delay=1.0)
    pipe.send(b"old", 0.0)
    pipe.cut = True
    assert pipe.receive(2.0) == []
    pipe.cut = False
    pipe.send(b"new", 2.0)
    assert pipe.receive(5.0) == [b"new"]
