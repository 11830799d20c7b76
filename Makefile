# make setup       .venv with everything, kernels compiled
# make experiment  the laboratory of 1997: three runs, three tables
# make test        the tests CI runs
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
CONSTRAINTS ?= constraints.txt
EXTRAS ?= all
# Whatever is started here keeps to this machine.
export ROS_AUTOMATIC_DISCOVERY_RANGE ?= LOCALHOST

.PHONY: setup experiment test test-slow test-oldest test-nightly lint bench bags trials clean

setup: $(VENV)/.done

$(VENV)/.done: setup.py $(CONSTRAINTS)
	$(PYTHON) -m venv --clear $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c $(CONSTRAINTS) -e '.[$(EXTRAS)]'
	$(BIN)/python -m kapitsa_ros.physics.compile_kernels
	touch $@

experiment: setup
	rm -rf experiment_1997
	$(BIN)/kapitsa experiment --preset as_built_1997 --bags experiment_1997

test: setup
	$(BIN)/python -m pytest -n 2 --dist loadgroup

test-slow: setup
	$(BIN)/python -m pytest -m slow

test-oldest:
	$(MAKE) test VENV=.venv-oldest CONSTRAINTS=constraints-oldest.txt EXTRAS=dev,report,bench,web,foxglove

test-nightly: setup
	.ci/nightly

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# The three recorded runs that are shipped.
bags: setup
	rm -rf bags/run_*
	$(BIN)/kapitsa experiment --preset as_built_1997 --seed 1997 --bags bags

# The virtual experiments on the presets that reports speak of, and the plans for them.
trials: setup
	$(BIN)/python -m kapitsa_ros.laboratory.preset_trials
	$(BIN)/python -m kapitsa_ros.laboratory.preset_plans

bench: setup
	$(BIN)/python benchmarks/run_all.py

clean:
	rm -rf .venv .venv-oldest experiment_1997 build install log
