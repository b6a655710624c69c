# The commands that the README and CI use. `make help` lists them.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PEERS := $(VENV)/peers
FUZZ := $(VENV)/fuzz
FUZZ_SECONDS ?= 600
UV := $(BIN)/uv --quiet
RUST_SOURCES := $(shell find crates -not -path '*/tests/*' \( -name '*.rs' -o -name 'Cargo.toml' \)) Cargo.toml Cargo.lock pyproject.toml
# Two workers keep two processors busy: threads of a linear algebra library would wait for each other.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 2
CARGO_TEST := cargo test --quiet --locked --workspace --exclude breakaway-python --features breakaway-core/serde,breakaway-batch/yardstick

.PHONY: help demo test test-build test-firmware check lint bench peers fuzz docs lock clean

help:
	@echo "make demo    set up, reproduce the paper into out/reproduction, write an advice into out/advice"
	@echo "make test    set up, then run every test"
	@echo "make test-build   compile the tests in Rust, and run none"
	@echo "make check   what takes less than a minute: static checks, and tests that are not slow"
	@echo "make test-firmware   exported controllers on an emulated Cortex-M4F; says what to install"
	@echo "make lint    formatting, static checks, layer rules, locks, known faults"
	@echo "make bench   measure speed and memory, into bench/results.json"
	@echo "make peers   the same loop in other tools, into bench/peers/results.md"
	@echo "make fuzz    damage files of others for FUZZ_SECONDS each, guided by coverage"
	@echo "make docs    Rust API pages, and the pictures of the README"
	@echo "make lock    resolve the Python lock files anew"

demo: $(VENV)/.built
	$(BIN)/breakaway reproduce --out out/reproduction
	$(BIN)/breakaway events examples/10_from_pull_to_report/part_1.csv --mass-kg 2 --out out/joint.toml
	$(BIN)/breakaway advise out/joint.toml --limits examples/10_from_pull_to_report/limits.toml --budget-s 20 --out out/advice

test: $(VENV)/.built $(VENV)/.development
	$(CARGO_TEST)
	cargo check --quiet --locked -p breakaway-core --no-default-features
	$(PYTEST)

test-build:
	$(CARGO_TEST) --no-run

check: $(VENV)/.built $(VENV)/.development
	$(BIN)/ruff check --quiet .
	$(BIN)/mypy
	$(PYTEST) -m "not slow" tests

test-firmware: $(VENV)/.built
	$(BIN)/python -m tests.firmware

lint: $(VENV)/.built $(VENV)/.development
	cargo fmt --all --check
	cargo clippy --quiet --locked --workspace --all-targets --features breakaway-core/serde,breakaway-batch/yardstick -- -D warnings
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python tools/check_circles.py
	$(BIN)/python tools/check_locks.py
	$(BIN)/python tools/check_known_faults.py

bench: $(VENV)/.built
	$(BIN)/python bench/measure.py

peers: $(VENV)/.built $(PEERS)/.installed
	PYTHONPATH=python $(PEERS)/bin/python -m bench.peers

fuzz: $(VENV)/.built $(FUZZ)/.installed
	PYTHONPATH=python:. $(FUZZ)/bin/python -m fuzz all -max_total_time=$(FUZZ_SECONDS)

docs: $(VENV)/.built
	cargo doc --quiet --locked --workspace --exclude breakaway-python --no-deps
	$(BIN)/python tools/draw_readme.py

# Setup, in steps that are redone only when what they read has changed. A build is as old as its
# beginning: sources that are edited while it goes on are newer.
$(VENV)/.installer: tools/check_toolchain.sh requirements/installer.lock
	@sh tools/check_toolchain.sh $(PYTHON)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/installer.lock
	$(BIN)/python -m pip uninstall --quiet --yes setuptools
	@touch $@

$(VENV)/.runtime: $(VENV)/.installer requirements/runtime.lock
	$(UV) pip install --python $(BIN)/python --require-hashes -r requirements/runtime.lock
	@touch $@

$(VENV)/.development: $(VENV)/.runtime requirements/dev.lock
	$(UV) pip install --python $(BIN)/python --require-hashes -r requirements/dev.lock
	@touch $@

$(VENV)/.built: $(VENV)/.runtime $(RUST_SOURCES)
	@touch $@.begun
	@sh tools/check_toolchain.sh $(PYTHON)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(UV) pip install --python $(BIN)/python --no-deps --no-build-isolation --reinstall-package breakaway --editable .
	@mv $@.begun $@

$(PEERS)/.installed: $(VENV)/.runtime bench/peers/requirements.lock
	$(PYTHON) -m venv $(PEERS)
	$(UV) pip install --python $(PEERS)/bin/python --require-hashes -r bench/peers/requirements.lock
	@touch $@

$(FUZZ)/.installed: $(VENV)/.runtime fuzz/requirements.lock
	$(PYTHON) -m venv $(FUZZ)
	$(UV) pip install --python $(FUZZ)/bin/python --require-hashes -r fuzz/requirements.lock
	@touch $@

lock: $(VENV)/.installer
	printf 'pip\nuv\n' | $(UV) pip compile - --universal --python-version 3.11 --generate-hashes --no-header --no-annotate --no-emit-index-url -o requirements/installer.lock
	$(UV) pip compile pyproject.toml --all-extras --group build --universal --python-version 3.11 --generate-hashes --no-header --no-emit-index-url -o requirements/runtime.lock
	$(UV) pip compile pyproject.toml --all-extras --group build --group dev --universal --python-version 3.11 --generate-hashes --no-header --no-emit-index-url -o requirements/dev.lock
	$(UV) pip compile pyproject.toml bench/peers/requirements.in --constraint requirements/runtime.lock --universal --python-version 3.11 --generate-hashes --no-header --no-emit-index-url -o bench/peers/requirements.lock
	$(UV) pip compile pyproject.toml fuzz/requirements.in --all-extras --group dev --constraint requirements/dev.lock --universal --python-version 3.11 --generate-hashes --no-header --no-emit-index-url -o fuzz/requirements.lock

clean:
	rm -rf $(VENV) target out
