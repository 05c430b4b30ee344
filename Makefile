# Development tasks. `make setup` first; every other target uses the .venv that it builds.

PYTEST = .venv/bin/pytest
NEEDS = @.venv/bin/python -m tests.extras
PARALLEL = -n auto --dist loadgroup

.PHONY: help setup check format test-fast test test-all stranger bare coverage bench soak stress vm aarch64 macos oldest mutate release docs picture deb deb-check wheels installs

help:  ## List the targets.
	@sed -n 's/^\([a-z0-9-]*\):[^#]*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 20

setup:  ## Create .venv with everything that development needs.
	python3 -m venv .venv
	.venv/bin/pip install -q -c constraints.txt -e '.[dev,interop]'
	@.venv/bin/pip install -q -c constraints.txt --only-binary lgpio lgpio 2>.venv/lgpio.log || \
		echo "no wheel of lgpio for this Python: the tests of its pins are skipped (.venv/lgpio.log)"

check: | .venv/bin/python  ## Check format, lint, types and import rules.
	$(NEEDS) dev ruff mypy importlinter
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/lint-imports

format: | .venv/bin/python  ## Format the code and sort the imports.
	$(NEEDS) dev ruff
	.venv/bin/ruff check --select I --fix -q .
	.venv/bin/ruff format .

test-fast: | .venv/bin/python  ## Test the cores and the safety code, in less than 20 s.
	$(NEEDS) test pytest xdist
	$(PYTEST) -q $(PARALLEL) -m 'not slow' $(FAST)

test: | .venv/bin/python  ## Run the short suite, as README.md does: 190 s of CPU.
	$(NEEDS) test pytest xdist
	$(PYTEST) $(PARALLEL)

test-all: | .venv/bin/python  ## Run every test, as CI does.
	$(NEEDS) test pytest xdist
	$(PYTEST) $(PARALLEL) --suite all

stranger:  ## Type the lines of README.md in a fresh clone, with an empty environment.
	python3 -m tests.stranger $(ARGS)

bare:  ## The same in a bare Debian, from its package list on; SUITE=bookworm; needs root and debootstrap.
	python3 -m tests.stranger --bare $(or $(SUITE),trixie) $(ARGS)

coverage: | .venv/bin/python  ## Fail if a branch of the safety code is not covered by the tests of its folder.
	$(NEEDS) dev coverage pytest
	.ci/coverage

bench: | .venv/bin/python  ## Measure; ARGS=--quick, or the names of benchmarks.
	.venv/bin/python -m tests.benchmarks $(ARGS)

soak: | .venv/bin/python  ## Drive for an hour over a bad network with programs killed in between; ARGS="--minutes 10 --seed 2".
	.venv/bin/python -m tests.soak $(ARGS)

stress: | .venv/bin/python  ## Run the tests of real programs and sockets 5 times with all cores busy; ARGS="--rounds 1 tests/e2e".
	$(NEEDS) test pytest
	.venv/bin/python -m tests.stress $(ARGS)

vm: | .venv/bin/python  ## Test pins, I2C, the service and a serial line against Debian's kernel in a virtual machine; needs root once.
	$(NEEDS) test pytest
	.venv/bin/python -m tests.vm $(ARGS)

aarch64: | .venv/bin/python  ## Test the core on an emulated aarch64, with Debian's Python for it; needs qemu-user-static.
	.venv/bin/python -m tests.aarch64 $(ARGS)

macos: | .venv/bin/python  ## Run the stops, the watchdog, the screen and verbs under the rules of macOS; ARGS="tests/e2e/test_gamepad.py".
	$(NEEDS) test pytest
	.venv/bin/python -m tests.macos_rules $(ARGS)

oldest: | .venv/bin/python  ## Run tests with the oldest allowed versions of all packages; needs a network.
	.venv/bin/python -m tests.oldest $(ARGS)

wheels: | .venv/bin/python  ## Fetch mavhelm and all that it needs as wheels for this computer into dist/wheels; needs a network.
	$(NEEDS) dev hatchling
	rm -rf dist/wheels
	SOURCE_DATE_EPOCH=$$(git log -1 --format=%ct) .venv/bin/python -m hatchling build -t wheel -d dist/wheels
	.venv/bin/pip wheel -q -c constraints.txt -w dist/wheels "$$(echo dist/wheels/*.whl)[all]"

installs: | .venv/bin/python  ## Type the install lines of docs/install.md without a network; needs make wheels, pipx, uv and root.
	.venv/bin/python -m tests.installs

deb: | .venv/bin/python  ## Assemble the Debian packages in dist/ from wheels; ARGS="--arch amd64 --suite trixie"; needs a network.
	$(NEEDS) dev hatchling packaging
	PYTHONPATH=packaging .venv/bin/python -m deb $(ARGS)

deb-check:  ## Check the packages of dist/ with lintian and in a bare Debian; needs root, debootstrap, qemu-user-static.
	lintian --fail-on error,warning dist/*.deb
	for package in dist/*.deb; do python3 -m tests.debian $(ARGS) $$package || exit 1; done

mutate: | .venv/bin/python  ## Change the safety code line by line and report what no test notices.
	.venv/bin/python -m tests.mutation $(ARGS)

docs: | .venv/bin/python  ## Build the documentation site in build/site, without a network; needs the extra [docs].
	$(NEEDS) docs mkdocs material
	NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --strict -q -f docs/mkdocs.yml

picture: | .venv/bin/python  ## Record a drive with the real program and draw docs/drive.png; needs rsvg-convert and the extra [pictures].
	.venv/bin/python -m tests.animation $(ARGS)

release:  ## Build the packages, and list the dependencies with their hashes, in dist/.
	.ci/release

.venv/bin/python:
	@echo "there is no .venv: make setup first" >&2; exit 1

FAST = tests/vehicle/drive tests/vehicle/safety tests/link/protocol tests/groundstation/input tests/dialects/test_axes.py
