PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
SCENARIO ?= aces
LOG := logs/runs/$(SCENARIO).mcap
PAGE := logs/runs/$(SCENARIO).html

.PHONY: run test check setup clean

run: setup ## launch the main scenario in separate processes, analyse its log, draw it
	$(BIN)/waywiser launch $(SCENARIO) --log $(LOG)
	$(BIN)/waywiser analyse $(LOG) --html $(PAGE)

test: check ## format, lint, types, house rules, tests
	$(BIN)/pytest -n auto

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

setup: $(VENV)/installed

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) build *.egg-info logs/runs
