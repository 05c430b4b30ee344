"""Fuzzing: bytes into everything that reads bytes of others. Nothing may raise but the error that names the fault.

    python -m tests.fuzz --list                          the targets
    python -m tests.fuzz vehicle --minutes 30 --seed 1   one target, guided by coverage (pip install -e '.[fuzz]')
    python -m tests.fuzz --minutes 240 --report f.json   all in turn, with processor time and inputs of each

`test_fuzz.py` runs each target with hypothesis and with the files in `corpus/TARGET/`. An input that raises is written
to that folder by the long run; it stays there once the fault is mended.
"""
