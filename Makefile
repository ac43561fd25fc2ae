# One command per chore; `make` alone lists them.
#
# Everything is installed into .venv at the versions of constraints.txt. Two stamps say how much:
# `core` is what users install, `full` adds what tests, docs and training need.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CORE := $(VENV)/.core
FULL := $(VENV)/.full
BLENDER := $(VENV)/cutis-blender/cutis-blender
INSTALL := $(BIN)/python -m pip --disable-pip-version-check install --quiet -c constraints.txt
PYTEST := $(BIN)/python -m pytest --quiet
# Worker processes of the tests; they share the cores among them.
WORKERS ?= auto
PARALLEL := --numprocesses $(WORKERS) --dist loadfile
# Rounds of new cases, and damaged files, of `make fuzz`.
ROUNDS ?= 5
FILES ?= 10000

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help setup setup-render demo quick test test-long fuzz lint types docs docs-check format clean

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 14

setup: $(FULL) ## make .venv with everything that tests, docs and training need

setup-render: $(BLENDER) ## also install Blender as a module, in .venv/cutis-blender (400 MB)

demo: $(CORE) ## run the demonstration on the example capture, into demo/
	$(BIN)/cutis demo -o demo

quick: lint types ## within a minute: style, types, and tests of what your change can reach
	$(PYTEST) $(PARALLEL) -m 'not slow and not long' --quick 60

test: setup lint types docs ## what has to pass: style, types, docs and tests
	$(PYTEST) $(PARALLEL) -m 'not long'

test-long: setup ## the tests that `make test` leaves out
	$(PYTEST) $(PARALLEL) -m long

fuzz: setup ## property tests on ROUNDS of new cases, then FILES damaged files
	for round in $$(seq $(ROUNDS)); do \
	  CUTIS_PROPERTIES=new $(PYTEST) $(PARALLEL) -m property || exit; done
	$(BIN)/python -m studies.fuzz --count $(FILES) --seed $$(date +%s)

lint: $(FULL) ## code style
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(FULL) ## static types
	$(BIN)/mypy

docs: $(FULL) ## build the documentation into site/
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

docs-check: $(FULL) ## name generated files that are older than what made them
	$(BIN)/python -m studies.generated

format: $(FULL) ## rewrite the code in the project's style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean: ## remove outputs and caches, keep .venv
	rm -rf build demo dist out site .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +

# Compiling on first use instead of at once saves a quarter of the time and 100 MB.
$(CORE): pyproject.toml constraints.txt
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) --no-compile -e .
	@touch $@

# In an environment of its own, because it pins other versions; with Python 3.11 or 3.13 only.
$(BLENDER): src/cutis/data/blender/constraints.txt | $(CORE)
	$(BIN)/cutis render --install --quiet
	@touch $@

$(FULL): pyproject.toml constraints.txt
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) -e '.[browser,cluster,dev,docs,materialx,mitsuba,onnx,studio,train]'
	@touch $(CORE) $@
