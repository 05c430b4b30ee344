# Development tasks. `make setup` first; every other target uses the .venv that it builds.

PYTEST = .venv/bin/pytest
PARALLEL = -n auto --dist loadgroup

.PHONY: help setup check format test-fast test test-all bench mutate

help:  ## List the targets.
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 20

setup:  ## Create .venv with everything that development needs.
	python3 -m venv .venv
	.venv/bin/pip install -q -c constraints.txt -e '.[dev,interop,pi]'

check:  ## Check format, lint, types and import rules.
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/lint-imports

format:  ## Format the code and sort the imports.
	.venv/bin/ruff check --select I --fix -q .
	.venv/bin/ruff format .

test-fast:  ## Test the cores and the safety code, in less than 20 s.
	$(PYTEST) -q $(PARALLEL) -m 'not slow' $(FAST)

test:  ## Run the tests that README.md runs: everything but the slow ones, in less than 4 minutes.
	$(PYTEST) $(PARALLEL) -m 'not slow'

test-all:  ## Run every test, as CI does.
	$(PYTEST) $(PARALLEL)

bench:  ## Measure; ARGS=--quick, or the names of benchmarks.
	.venv/bin/python -m tests.benchmarks $(ARGS)

mutate:  ## Change the safety code line by line and report what no test notices.
	.venv/bin/python -m tests.mutation $(ARGS)

FAST = tests/vehicle/drive tests/vehicle/safety tests/link/protocol tests/groundstation/input tests/dialects/test_axes.py
