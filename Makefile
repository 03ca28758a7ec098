# make demo   learn a burger world model from pictures and solve unseen tasks (no key, no network beyond installing)
# make test   run the tests            make check   ruff and mypy --strict
# make test-all   install every extra and run the tests that need one; none may be skipped
# make bench-smoke   a cut of the published comparison, as a table (make test-all runs it too)
# make docs       build the documentation as a site into build/site; warnings are errors
# make wheel      build wheel and sdist into dist/, install the wheel alone into a new environment, run the demos there
# make wheel-extra   the same, then the wheel with an extra: a simulator draws
# make licences   the same, and the licence of everything the core needs; fails on the GPL
# make newest     the same tests with the newest versions of every dependency, in an environment of its own
# Every target sets up .venv by itself, with the versions in constraints.txt. PYTHON=python3.12 make demo   uses another interpreter.

PYTHON ?= python3
VENV ?= .venv
CONSTRAINTS ?= constraints.txt
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check $(if $(CONSTRAINTS),-c $(CONSTRAINTS))
TORCH ?= torch==2.13.0

.PHONY: demo test test-all newest docs wheel wheel-extra licences bench-smoke check clean
.DEFAULT_GOAL := demo

$(VENV)/run.stamp: pyproject.toml $(CONSTRAINTS)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "pix2pred needs Python 3.11 or newer; try: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	test -d $(VENV) || $(PYTHON) -m venv $(VENV)
	$(INSTALL) -e .
	@touch $@

$(VENV)/dev.stamp: $(VENV)/run.stamp
	$(INSTALL) -e '.[dev]'
	@touch $@

$(VENV)/all.stamp: $(VENV)/dev.stamp
	$(INSTALL) '$(TORCH)' -e '.[dev,all]'
	@touch $@

$(VENV)/docs.stamp: $(VENV)/run.stamp
	$(INSTALL) -e '.[docs]'
	@touch $@

demo: $(VENV)/run.stamp
	$(BIN)/pix2pred demo

test: $(VENV)/dev.stamp
	$(BIN)/python -m pytest -n auto --dist loadfile

test-all: $(VENV)/all.stamp
	PIX2PRED_NO_SKIPS=1 $(BIN)/python -m pytest -n auto --dist loadfile -m extra
	$(MAKE) bench-smoke

newest:
	$(MAKE) VENV=.venv-newest CONSTRAINTS= check test

docs: $(VENV)/docs.stamp
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo 'open build/site/index.html (with its search: $(BIN)/python -m http.server --directory build/site --bind 127.0.0.1)'

WHEEL := .venv-wheel
wheel: $(VENV)/dev.stamp
	rm -rf dist $(WHEEL)
	$(BIN)/python -m build --outdir dist . >/dev/null
	$(PYTHON) -m venv $(WHEEL)
	$(WHEEL)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt dist/*.whl
	$(WHEEL)/bin/python -m pip check
	cd dist && ../$(WHEEL)/bin/pix2pred demo --count 2 --out demo
	cd dist && ../$(WHEEL)/bin/pix2pred demo --recorded --count 2 --out demo

wheel-extra: wheel
	$(WHEEL)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt "$$(ls dist/*.whl)[sim]"
	cd dist && rm -rf kitchen && ../$(WHEEL)/bin/pix2pred generate kitchen --out kitchen

licences: wheel
	$(BIN)/pip-licenses --python $(WHEEL)/bin/python --partial-match --fail-on 'GNU General Public;GPL-2;GPL-3;AGPL'

bench-smoke: $(VENV)/run.stamp
	$(BIN)/pix2pred bench run smoke --jobs 2
	$(BIN)/pix2pred bench report runs/bench-smoke

check: $(VENV)/dev.stamp
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

clean:
	rm -rf $(VENV) .venv-newest $(WHEEL) .mypy_cache .ruff_cache .pytest_cache build dist
