"""Mutation testing of the safety code: change one place of it at a time and report the changes that no test notices.

    python -m tests.mutation                              all rooms (`ROOMS`, __main__.py)
    python -m tests.mutation vehicle/drive/gate.py        one module
    python -m tests.mutation --list vehicle/drive         list the mutants, run no test
    python -m tests.mutation --jobs 2                     two processes
    python -m tests.mutation --results FILE               keep results; started again, go on where it ended

A mutant changes one comparison, operator, number, condition, enum member, return value or call, or removes a statement
(changes.py). A mutant is killed if a test fails or exceeds its time limit. A survivor is a gap in the tests: write the
missing test. If the change has no effect that a test could see (an equivalent mutant), explain it in survivors.toml.
The run fails if a survivor has no explanation, and if an explanation fits no survivor.

How a run works:

1. pytest collects the tests of the rooms once (`ROOMS`, __main__.py). A forked child runs them on the unchanged code
   under coverage and records the lines that each test executes and its duration (baseline.py).
2. Each mutant gets a forked child (runner.py). For a change inside a function, the child replaces the `__code__` of the
   loaded function (loading.py) and runs the tests that execute the changed line, likely and fast ones first, until one
   fails or the time for this mutant is over. For a line that only a process executes which a test forks, it runs the
   module's own test file.
3. For a change at module level (tables, defaults, constants), the child imports vehicle/, link/, groundstation/ and
   tests/ anew and runs the test files one after the other, the module's own first, that and tests/test_bounds.py in any
   case.

Tests that start programs (`DESELECTED`) run unchanged code in them and notice no mutant.

With --results, a mutant that was killed is not run again while its module is the same, and a survivor not while the
tests are the same, too (results.py).

Hypothesis draws the same examples in each run and does not shrink failures.

Why not a library: mutmut 3 does not mutate module level and properties (RULES, TRANSITIONS, `Clearance.permit`), and
numbers its mutants, so that explanations go stale with each edit. cosmic-ray starts pytest for each mutant.
"""
