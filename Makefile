# Everything runs in .venv, which every target below sets up by itself.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Tests start many processes, which must not compile the package again each time.
unexport PYTHONDONTWRITEBYTECODE
CORE := CMakeLists.txt pyproject.toml constraints.txt $(shell find core -name '*.h' -o -name '*.hpp' -o -name '*.cpp')

PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: setup demo reproduction test app-test verify sanitize sanitize-memory sanitize-threads coverage mutate lint stub docs docs-light gallery wheel bench \
    bench-guard format clean

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
	$(BIN)/python -m pytest -n 2 --dist worksteal --durations=10 -m 'not slow and not browser'

# The application in a browser, if there is one; its simulated page is among the other tests. ONLY=--lf runs what failed last.
app-test: setup
	$(BIN)/python -m pytest -q -rs -m 'browser and not slow' $(ONLY) tests/browser

verify: setup sanitize coverage mutate
	$(BIN)/python -m pytest -n 2 --dist worksteal --durations=10 -m slow

sanitize: sanitize-memory sanitize-threads

# The core is compiled with sanitizers of GCC into build/NAME/package. Python runs without `site` (-S), because an editable
# installation would come first, and at fixed addresses (setarch -R), which ThreadSanitizer needs. Tests that start other
# processes are left out: those would load the core without the sanitizer.
comma := ,
SITE = $(shell $(BIN)/python -c "import sysconfig; print(sysconfig.get_path('purelib'))")
LEVEL = $(if $(filter x86_64 amd64,$(shell uname -m)),v3,native)
LIBRARY = $(shell $(CXX) -print-file-name=$(1))
define sanitized
	$(PIP) --no-deps --no-build-isolation --upgrade \
	    --target build/$(1)/package -Cbuild-dir=build/$(1)/cmake -Cinstall.strip=false -Ccmake.build-type=Debug \
	    -Ccmake.define.RATTLEBOX_LEVELS=$(LEVEL) -Ccmake.define.RATTLEBOX_OPTIMIZATION=-O1 "-Ccmake.define.CMAKE_CXX_FLAGS=$(2)" .
	LD_PRELOAD="$(call LIBRARY,lib$(1).so) $(call LIBRARY,libstdc++.so.6)" PYTHONPATH=$(CURDIR)/build/$(1)/package:$(SITE) \
	    setarch -R $(BIN)/python -S -m pytest -q -m 'not slow'
endef

# Leaks are not looked for: Python itself does not free all of its memory at its end.
sanitize-memory: export ASAN_OPTIONS := detect_leaks=0
sanitize-memory: setup
	$(call sanitized,asan,-fsanitize=address$(comma)undefined -fno-sanitize-recover=undefined) tests/unit/engines tests/verification/dem/test_normal.py -k 'not core_stub'

# Threads of BLAS, which has no sanitizer, would be reported as races.
sanitize-threads: export TSAN_OPTIONS := halt_on_error=1
sanitize-threads: export OPENBLAS_NUM_THREADS := 1
sanitize-threads: setup
	$(call sanitized,tsan,-fsanitize=thread) tests/verification/dem/test_bits.py -k 'not another_process'

# Branch coverage of each package by the fast tests; `make mutate` needs its data.
coverage: export COVERAGE_FILE := build/coverage
coverage: setup
	mkdir -p build
	$(BIN)/python -m pytest -n 2 --dist worksteal -q -m 'not slow and not browser' --cov=rattlebox --cov-branch --cov-context=test --cov-report= \
	    --junitxml=build/tests.xml
	for package in $(filter-out __pycache__,$(notdir $(patsubst %/,%,$(wildcard src/rattlebox/*/)))); do \
	    echo "$$package: $$($(BIN)/coverage report --format=total --include="src/rattlebox/$$package/*") %"; done

mutate: coverage
	$(BIN)/python tools/mutate.py --minutes 10

# Wheels for Linux x86-64 in dist/, by zig, each tried in a fresh environment. PYTHONS=... chooses the interpreters.
wheel: | $(BIN)/python
	$(BIN)/python tools/wheel.py $(PYTHONS)

bench: setup
	$(BIN)/python benchmarks/bench.py

# Speed against the last tag, or against SINCE=COMMIT.
bench-guard: setup
	$(BIN)/python benchmarks/guard.py $(if $(SINCE),--since $(SINCE))

# Systems for which the core must compile. The objects serve until the core changes.
SYSTEMS := x86_64-linux-gnu.2.28 aarch64-linux-gnu.2.28 aarch64-macos x86_64-windows-gnu wasm32-wasi
COMPILED := $(SYSTEMS:%=build/portable/%.o)
HEADERS := $(filter-out core/bindings/%,$(filter %.h %.hpp,$(CORE)))

$(COMPILED): build/portable/%.o: tests/portable/cases.cpp $(HEADERS) constraints.txt | $(VENV)/.installed
	@mkdir -p $(@D)
	@echo compiling the core for $*
	@$(BIN)/python -m ziglang c++ -target $* -std=c++20 -O0 -g0 -fno-sanitize=undefined -fopenmp-simd -Wall -Wextra -Wno-psabi -Werror \
		-Icore $(HEADERS:%=-include %) -c $< -o $@

lint: setup $(COMPILED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo --no-cache
	$(BIN)/clang-format --dry-run --Werror $(shell git ls-files 'core/*.hpp' 'core/*.cpp' 'tests/*.cpp')
	$(BIN)/python tools/size.py

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(shell git ls-files 'core/*.hpp' 'core/*.cpp' 'tests/*.cpp')

# The types of the compiled core, after a change of core/bindings or of the table of laws.
stub: setup
	cd src && ../$(BIN)/python -m nanobind.stubgen -q -m $$(../$(BIN)/python -c "from rattlebox.core.choose import core; print(core().__name__)") -o rattlebox/core/_core.pyi

# The pages, with the figures of docs/_static in the gallery of examples.
docs: setup
	$(BIN)/sphinx-build -W --keep-going -b html docs docs/_build/html

# The pages without a compiler: the libraries of the package and Sphinx, 0.6 GB in place of 2.3 GB, and no core.
LIGHT := .venv-docs
REQUIREMENTS := import tomllib; project = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
    print(*project["dependencies"], *project["optional-dependencies"]["docs"], sep="\n")

$(LIGHT)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(LIGHT)
	$(LIGHT)/bin/python -c '$(REQUIREMENTS)' > $(LIGHT)/requirements.txt
	$(LIGHT)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -r $(LIGHT)/requirements.txt
	touch $@

docs-light: $(LIGHT)/.installed
	PYTHONPATH=src $(LIGHT)/bin/sphinx-build -W --keep-going -b html docs docs/_build/html

# The same, with the scripts of the gallery run, so that their output is on their pages, and their figures in docs/_static.
gallery: setup
	$(BIN)/sphinx-build -W -b html -D plot_gallery=True docs docs/_build/html

clean:
	rm -rf $(VENV) $(LIGHT) build docs/_build docs/gallery
