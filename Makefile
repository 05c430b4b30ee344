# Development tasks. `make setup` first; every other target uses the .venv that it builds.

PYTEST = .venv/bin/pytest
PARALLEL = -n auto --dist loadgroup

.PHONY: help setup check format test-fast test test-all stranger bare coverage bench soak stress vm aarch64 oldest mutate release docs picture deb deb-check wheels installs

help:  ## List the targets.
	@sed -n 's/^\([a-z0-9-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 20

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

test:  ## Run the short suite, as README.md does: 250 s of CPU.
	$(PYTEST) $(PARALLEL)

test-all:  ## Run every test, as CI does.
	$(PYTEST) $(PARALLEL) --suite all

stranger:  ## Type the lines of README.md in a fresh clone, with an empty environment.
	python3 -m tests.stranger $(ARGS)

bare:  ## The same in a bare Debian, from its package list on; SUITE=bookworm; needs root and debootstrap.
	python3 -m tests.stranger --bare $(or $(SUITE),trixie) $(ARGS)

coverage:  ## Fail if a branch of the safety code is not covered by the tests of its folder.
	.ci/coverage

bench:  ## Measure; ARGS=--quick, or the names of benchmarks.
	.venv/bin/python -m tests.benchmarks $(ARGS)

soak:  ## Drive for an hour over a bad network with programs killed in between; ARGS="--minutes 10 --seed 2".
	.venv/bin/python -m tests.soak $(ARGS)

stress:  ## Run the tests of real programs and sockets 5 times with all cores busy; ARGS="--rounds 1 tests/e2e".
	.venv/bin/python -m tests.stress $(ARGS)

vm:  ## Test pins, I2C, the service and a serial line against Debian's kernel in a virtual machine; needs root once.
	.venv/bin/python -m tests.vm $(ARGS)

aarch64:  ## Test the core on an emulated aarch64, with Debian's Python for it; needs qemu-user-static.
	.venv/bin/python -m tests.aarch64 $(ARGS)

oldest:  ## Run tests with the oldest allowed versions of all packages; needs a network.
	.venv/bin/python -m tests.oldest $(ARGS)

wheels:  ## Fetch mavhelm and all that it needs as wheels for this computer into dist/wheels; needs a network.
	rm -rf dist/wheels
	SOURCE_DATE_EPOCH=$$(git log -1 --format=%ct) .venv/bin/python -m hatchling build -t wheel -d dist/wheels
	.venv/bin/pip wheel -q -c constraints.txt -w dist/wheels "$$(echo dist/wheels/*.whl)[all]"

installs:  ## Type the install lines of docs/install.md without a network; needs make wheels, pipx, uv and root.
	.venv/bin/python -m tests.installs

deb:  ## Assemble the Debian packages in dist/ from wheels; ARGS="--arch amd64 --suite trixie"; needs a network.
	PYTHONPATH=packaging .venv/bin/python -m deb $(ARGS)

deb-check:  ## Check the packages of dist/ with lintian and in a bare Debian; needs root, debootstrap, qemu-user-static.
	lintian --fail-on error,warning dist/*.deb
	for package in dist/*.deb; do python3 -m tests.debian $(ARGS) $$package || exit 1; done

mutate:  ## Change the safety code line by line and report what no test notices.
	.venv/bin/python -m tests.mutation $(ARGS)

docs:  ## Build the documentation site in build/site, without a network; needs the extra [docs].
	NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --strict -q -f docs/mkdocs.yml

picture:  ## Record a drive with the real program and draw docs/drive.png; needs rsvg-convert and the extra [pictures].
	.venv/bin/python -m tests.animation $(ARGS)

release:  ## Build the packages, and list the dependencies with their hashes, in dist/.
	.ci/release

FAST = tests/vehicle/drive tests/vehicle/safety tests/link/protocol tests/groundstation/input tests/dialects/test_axes.py
