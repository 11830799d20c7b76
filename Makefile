# make setup       .venv with everything, kernels compiled
# make experiment  the laboratory of 1997: three runs, three tables
# make test        the tests CI runs
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PIP_INSTALL := $(BIN)/pip install --quiet --disable-pip-version-check
# Whatever is started here keeps to this machine.
export ROS_AUTOMATIC_DISCOVERY_RANGE ?= LOCALHOST

.PHONY: setup experiment test test-slow test-oldest test-nightly lint bench bags trials clean

setup: $(VENV)/.done

# Nothing is installed whose hash requirements.txt does not have: what builds from source is built by setuptools of there.
$(VENV)/.done: setup.py requirements.txt
	$(PYTHON) -m venv --clear $(VENV)
	$(PIP_INSTALL) --require-hashes --only-binary :all: -r requirements-build.txt
	$(PIP_INSTALL) --require-hashes --no-build-isolation --no-deps -r requirements.txt
	$(PIP_INSTALL) --no-build-isolation --no-deps -e .
	$(BIN)/pip check --disable-pip-version-check
	$(BIN)/python -m kapitsa_ros.physics.compile_kernels
	touch $@

.venv-oldest/.done: setup.py constraints-oldest.txt
	$(PYTHON) -m venv --clear .venv-oldest
	$(PIP_INSTALL) -c constraints-oldest.txt -e '.[dev,report,bench,web,foxglove]'
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
	$(MAKE) test VENV=.venv-oldest

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
