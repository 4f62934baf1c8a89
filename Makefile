# Everything runs in .venv, which every target below sets up by itself.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Tests start many processes, which must not compile the package again each time.
unexport PYTHONDONTWRITEBYTECODE
CORE := CMakeLists.txt pyproject.toml constraints.txt $(shell find core -name '*.hpp' -o -name '*.cpp')

PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: setup demo reproduction test verify lint stub docs bench bench-guard format clean

setup: $(VENV)/.installed

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: $(CORE) | $(BIN)/python
	$(PIP) scikit-build-core nanobind cmake ninja
	$(PIP) --no-build-isolation -C cmake.define.RATTLEBOX_LEVELS=all -e '.[dev,docs]'
	touch $@

# The package with its required libraries, and the core for this machine only. Where everything is installed, that is used.
$(VENV)/.package: $(CORE) | $(BIN)/python
	$(PIP) --no-compile scikit-build-core nanobind cmake ninja
	$(PIP) --no-compile --no-build-isolation -C cmake.define.RATTLEBOX_LEVELS=best -e .
	touch $@

PACKAGE := $(VENV)/$(if $(wildcard $(VENV)/.installed),.installed,.package)

demo: $(PACKAGE)
	$(BIN)/rattlebox demo -o demo
	$(BIN)/python -m reproduction --only paper -o demo/report

reproduction: $(PACKAGE)
	$(BIN)/python -m reproduction -o report

# A worker takes tests that follow each other, so that most module fixtures are built once.
test: setup
	$(BIN)/python -m pytest -n 2 --dist worksteal --durations=10 -m 'not slow'

verify: setup
	$(BIN)/python -m pytest -n 2 --dist worksteal --durations=10 -m slow

bench: setup
	$(BIN)/python benchmarks/bench.py

# Speed against the last tag, or against SINCE=COMMIT.
bench-guard: setup
	$(BIN)/python benchmarks/guard.py $(if $(SINCE),--since $(SINCE))

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo --no-cache
	$(BIN)/clang-format --dry-run --Werror $(shell git ls-files 'core/*.hpp' 'core/*.cpp')

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(shell git ls-files 'core/*.hpp' 'core/*.cpp')

# The types of the compiled core, after a change of core/bindings or of the table of laws.
stub: setup
	cd src && ../$(BIN)/python -m nanobind.stubgen -q -m $$(../$(BIN)/python -c "from rattlebox.core.choose import core; print(core().__name__)") -o rattlebox/core/_core.pyi

docs: setup
	$(BIN)/sphinx-build -W --keep-going -b html docs docs/_build/html

clean:
	rm -rf $(VENV) build docs/_build
