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

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help setup blender demo test lint types docs format clean

help: ## list the targets
	@sed -n 's/^\([a-z]*\):.*## /\1\t/p' Makefile | expand -t 10

setup: $(FULL) ## make .venv with everything that tests, docs, training and renders need
	@$(MAKE) --no-print-directory blender || echo 'without Blender: tests that render are skipped'

blender: $(BLENDER) ## install Blender as a module, in .venv/cutis-blender

demo: $(CORE) ## run the demonstration on the example capture, into demo/
	$(BIN)/cutis demo -o demo

test: setup lint types docs ## lint, types, docs and all tests
	$(BIN)/python -m pytest

lint: $(FULL) ## code style
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(FULL) ## static types
	$(BIN)/mypy

docs: $(FULL) ## build the documentation into site/
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

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
	$(INSTALL) -e '.[cluster,dev,docs,materialx,mitsuba,onnx,train]'
	@touch $(CORE) $@
