"""Mutation testing of the safety code: changes one spot of it at a time, and reports the changes that no test notices.

    python -m tests.mutation                              all of vehicle/drive and vehicle/safety
    python -m tests.mutation vehicle/drive/gate.py        one module
    python -m tests.mutation --list vehicle/drive         the mutants, without running a test
    python -m tests.mutation --jobs 2

A mutant is one changed comparison, operator, number, condition, enum member, return value or call, or one statement
less (mutants.py). A mutant that a test fails on is killed, and so is one that runs into the time limit. A survivor is
a gap in the tests: write the missing test. Where the change cannot be seen from outside (an equivalent mutant), explain
it in survivors.toml. The run fails with a survivor that is not explained and with an explanation that fits no survivor.

How a run works (runner.py):

1. pytest collects the tests of `TESTS` once. A forked child runs all of them under coverage, which gives the lines
   that each test executes and how long it takes.
2. Each mutant gets a forked child of its own. A change inside a function replaces the `__code__` of the loaded
   function, so that nothing is imported again; the tests that execute the changed line run, likely and fast ones
   first, until one fails.
3. A change outside functions (tables, defaults, constants) is imported anew, with everything of vehicle/ and tests/,
   and the test files run one after the other, the module's own first.

Hypothesis draws the same examples in each run, and does not shrink what it finds.

Why no library: mutmut 3 leaves out module level and properties, thus RULES, TRANSITIONS and `Clearance.permit`, and
numbers its mutants, so that an explanation does not survive an edit. cosmic-ray starts pytest anew for each mutant.
"""
