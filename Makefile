# tipoff: `make report` and `make test` do everything from a fresh clone; the rest is for one stage at a time.
#
#   make report SCENE=sensitive OUT=/tmp/out      another scene, another place for the results
#   make test PYTHON=python3.13                   another Python for the environment

SCENE ?= reference
OUT ?= out
PYTHON ?= python3

TIPOFF = .venv/bin/tipoff
# The same with the studies that are evidence about tipoff, and are not installed with it.
EVIDENCE = .venv/bin/python -m validation
ASKED = --scene $(SCENE) --out $(OUT)
READY = .venv/.ready
CHECKED = .venv/.checked
DOCUMENTED = .venv/.documented
EXAMPLED = .venv/.exampled
# A worker that crashes ends the run and its test is named. If pytest replaced the worker, it would wait without end.
PARALLEL = --numprocesses=auto --dist=loadfile --max-worker-restart=0
# Tests that take a second or two each where kernels are compiled.
QUICK = tests/test_layers.py tests/test_sources.py tests/scenes tests/results tests/meshes \
  $(filter-out tests/mechanics/test_pushers.py,$(wildcard tests/mechanics/test_*.py)) \
  $(patsubst %,tests/highfi/%,elements mesh statics extruded contact/test_hertz.py test_compliance.py) \
  tests/highfi/statics/test_stable_step.py $(patsubst %,tests/highfi/dynamics/test_%.py,waves bars) \
  $(patsubst %,tests/lowfi/test_%.py,ejection numerics statuses tip_off) \
  $(patsubst %,tests/lowfi/contact/test_%.py,thermal_offset extreme_contacts friction) tests/lowfi/dynamics/test_momentum.py \
  tests/studies/test_names.py tests/studies/agreement tests/studies/cost/test_choice.py tests/studies/sweeps/test_knee.py \
  tests/workspace/test_models.py tests/studies/report

.DEFAULT_GOAL := help
.PHONY: help mesh highfi lowfi calibrate compare blind cost stability ablation ensemble sensitivity sweeps montecarlo limits flight measured curves paper recovery flights report view pictures peers convergence rails full-report bench docs examples examples-ready check coverage hooks test test-slow fuzz wheel clean

help: ## print this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## /{printf "  make %-14s %s\n", $$1, $$2}' Makefile
	@echo "  SCENE=$(SCENE) OUT=$(OUT)"

mesh: $(READY) ## mesh the rails of the scene
	$(TIPOFF) view --mesh $(ASKED)

highfi: $(READY) ## run the finite-element reference
	$(TIPOFF) run --all --model finite-elements $(ASKED)

lowfi: $(READY) ## run the surrogate, model compliant
	$(TIPOFF) run --all $(ASKED)

calibrate: $(READY) ## take the surrogate's contact from the finite elements: rail compliance, constants of springs
	$(TIPOFF) calibrate $(ASKED)

compare: $(READY) ## agreement of both, fitted and held-out conditions, beside the floor
	$(TIPOFF) compare $(ASKED)

cost: $(READY) ## what accuracy costs in time, and how it grows with elements, pads and effects
	$(TIPOFF) cost $(ASKED)
	$(EVIDENCE) scaling $(ASKED)

stability: $(READY) ## hard cases, with the weaker methods that fail on them
	$(EVIDENCE) stability $(ASKED)

ablation: $(READY) ## what each effect changes and costs
	$(TIPOFF) ablation $(ASKED)

ensemble: $(READY) ## 10,000 varied cases of the surrogate: what rates to expect (CASES=1000000 for a million)
	$(TIPOFF) ensemble $(ASKED) $(if $(CASES),--cases $(CASES))

measured: $(READY) ## logs of drop tests and launches (LOGS="a.toml b.toml"; default: simulated ones) among 1,000 simulated cases
	$(TIPOFF) measured $(LOGS) $(ASKED) $(if $(CASES),--cases $(CASES))

curves: $(READY) ## curves of other codes against the first (FILES="dyna=rbdout adams=adams.tab"; options in WITH)
	$(TIPOFF) curves $(FILES) $(ASKED) $(WITH)

blind: $(READY) ## agreement on conditions drawn now, by a seed that nobody chose
	$(TIPOFF) compare --blind 8 $(ASKED)

sensitivity: $(READY) ## which numbers the answer depends on: contact constants, Sobol' indices
	$(TIPOFF) sensitivity $(ASKED)

sweeps: $(READY) ## how large misalignment and eccentricities may be: 3,600 cases
	$(TIPOFF) sensitivity --sweep 120 $(ASKED)

montecarlo: $(READY) ## the paper's random errors, its 1,000 cases and 1,000,000 (CASES=10000 for fewer): rates, tails, readings (REFERENCE=60: checked by 60 runs of the reference)
	$(EVIDENCE) montecarlo $(ASKED) $(if $(CASES),--cases $(CASES)) $(if $(REFERENCE),--reference $(REFERENCE))

limits: $(READY) ## tolerances that keep the rates below limits (LIMIT="5 deg/s" PROBABILITY=0.99; CERTIFY=200: checked by runs of the reference), beside those the paper advises
	$(TIPOFF) limits $(ASKED) $(if $(LIMIT),--limit "$(LIMIT)") $(if $(PROBABILITY),--probability $(PROBABILITY)) $(if $(CERTIFY),--certify $(CERTIFY))

paper: $(READY) ## what the paper's unpublished inputs must have been, its tables beside ours
	$(EVIDENCE) paper $(ASKED)

recovery: $(READY) ## whether calibration finds hidden values: 20 draws with noise, and a reference
	$(EVIDENCE) recovery $(ASKED)

flight: $(READY) ## after separation: miss of a target in orbit, pointing, coning, whether it touches again
	$(TIPOFF) flight $(ASKED) $(if $(CASES),--cases $(CASES))

flights: $(READY) ## two measured launches beside predictions: RECORDS=folder with the records
	$(EVIDENCE) flights --out $(OUT) $(if $(RECORDS),--records $(RECORDS))

bench: $(READY) ## speed of the solvers against what one would write today: OUT/bench
	$(EVIDENCE) bench --out $(OUT)
	$(EVIDENCE) waits --out $(OUT)

report: $(READY) ## mesh to ablation, made where out of date, with all other studies that were made: OUT/SCENE/report.html
	$(EVIDENCE) report $(ASKED)

view: $(READY) ## one run to look at: VTK files for ParaView, and pictures if `make pictures` was made before
	$(TIPOFF) view $(ASKED)

pictures: $(READY) ## add pyvista (0.6 GB) to .venv, with which `make view` draws too
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements-view.lock

peers: $(READY) ## the same work in other codes: installs exudyn, mujoco and rocketpy into .venv, runs them and ccx (apt-get install calculix-ccx)
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements-peers.lock
	$(EVIDENCE) peers --out $(OUT) $(if $(KEEP),--keep)
	.venv/bin/python -m pytest -q -n0 tests/results/test_hand_over.py

convergence: $(READY) ## the error of the reference itself: meshes, steps, interface stiffness, quadrature (minutes)
	$(TIPOFF) convergence $(ASKED)
	$(EVIDENCE) ripple $(ASKED)

rails: $(READY) ## two more rails, calibrated and judged at 4 mm: they stand on the page of SCENE
	set -e; for rail in $(filter-out $(SCENE),thin titanium); do \
	  $(TIPOFF) compare --scene $$rail --set studies.element_size="4 mm" --out $(OUT); done

# Each line goes on where it was interrupted. The launches of other scenes are those of the tutorials.
full-report: rails ## everything again from one state: all studies, other rails, tails, launchers, speeds, pages of results (hours)
	$(EVIDENCE) montecarlo $(ASKED) --cases 100000 --reference 118 --finer 6
	$(EVIDENCE) report --every $(ASKED)
	$(TIPOFF) compare --scene cubesat_3u --neighbours 120 --out $(OUT)
	$(TIPOFF) compare --scene rocket_rail --set studies.element_size="10 mm" --neighbours 180 --out $(OUT)
	$(if $(RECORDS),$(EVIDENCE) flights --out $(OUT) --records $(RECORDS))
	$(EVIDENCE) bench --out $(OUT)
	$(if $(filter reference,$(SCENE)),.venv/bin/python -m validation.documents.readme $(OUT)/$(SCENE))

docs: $(DOCUMENTED) ## the documentation site, every warning an error: docs/_build/index.html
	.venv/bin/python -m sphinx --fail-on-warning --keep-going --quiet -b html docs docs/_build

examples: $(EXAMPLED) ## what if? A page in the browser with sliders, for any SCENE
	.venv/bin/marimo run docs/examples/what_if.py -- --scene $(SCENE)

examples-ready: $(EXAMPLED) ## add what the examples need to .venv, so that `make test` runs them too

check: $(CHECKED) ## format, lint, types and the quick tests: within a minute where kernels are compiled
	.venv/bin/ruff format --check --quiet .
	.venv/bin/ruff check --quiet .
	.venv/bin/mypy
	.venv/bin/python -m pytest -m "not slow" $(PARALLEL) $(QUICK)

coverage: $(CHECKED) ## the tests with the share of lines they run (kernels are compiled and not counted)
	.venv/bin/python -m pytest -m "not slow" $(PARALLEL) --cov --cov-report=term:skip-covered

hooks: $(CHECKED) ## format, lint and types before each commit
	.venv/bin/pre-commit install

test: $(READY) ## the tests, without the slow ones
	.venv/bin/python -m tests.warm
	.venv/bin/python -m pytest -m "not slow" $(PARALLEL)

test-slow: $(READY) ## every test
	.venv/bin/python -m tests.warm
	.venv/bin/python -m pytest $(PARALLEL)

fuzz: $(READY) ## 10,000 mutants of scenes, meshes, solids, tables and logs, then kills and full disks (COUNT=500 for fewer)
	.venv/bin/python -m tests.warm
	.venv/bin/python -m tests.fuzz $(if $(COUNT),--count $(COUNT))

# The kernels are compiled for a level of processors instead of this one, and lie in the package.
wheel: $(READY) ## dist/: a wheel with compiled kernels for this Python and Linux on x86-64-v3, and a source distribution; both checked, and run in a fresh environment (10 minutes)
	rm -rf build dist tipoff/kernels/made
	.venv/bin/python -c "from setuptools.build_meta import build_sdist; build_sdist('dist')"
	NUMBA_CPU_NAME=x86-64-v3 NUMBA_CPU_FEATURES= NUMBA_CACHE_DIR=$(CURDIR)/build/made .venv/bin/python -m tests.warm
	NUMBA_CPU_NAME=x86-64-v3 NUMBA_CPU_FEATURES= NUMBA_CACHE_DIR=$(CURDIR)/build/made $(TIPOFF) run --condition phi35 --out build/out
	NUMBA_CPU_NAME=x86-64-v3 NUMBA_CPU_FEATURES= NUMBA_CACHE_DIR=$(CURDIR)/build/made $(TIPOFF) ensemble --scene rocket_rail --cases 4 --out build/out
	mkdir tipoff/kernels/made && cp -r build/made/kernels/tipoff.* tipoff/kernels/made
	.venv/bin/python -c "import sys; from setuptools.build_meta import build_wheel; tag = f'--python-tag=cp{sys.version_info[0]}{sys.version_info[1]}'; \
	  build_wheel('dist', {'--build-option': [tag, '--plat-name=manylinux_2_28_x86_64']})"
	rm -rf tipoff/kernels/made
	.venv/bin/python -m venv build/fresh
	build/fresh/bin/python -m pip install --quiet --disable-pip-version-check twine==7.0.0 dist/*.whl
	build/fresh/bin/twine check --strict dist/*
	cd build/fresh && bin/tipoff --version && NUMBA_CACHE_DIR=cache bin/tipoff run --scene tiny --condition phi15
	rm -rf build

clean: ## remove results and caches; the environment stays
	rm -rf out build docs/_build *.egg-info .pytest_cache .hypothesis
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +

$(CHECKED): requirements-check.lock $(READY)
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements-check.lock
	@touch $@

$(DOCUMENTED): requirements-docs.lock $(READY)
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements-docs.lock
	@touch $@

$(EXAMPLED): requirements-examples.lock $(READY)
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements-examples.lock
	@touch $@

# The environment. The stamp is written last, so an install that was cut short is taken up again.
$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "tipoff needs Python 3.11 or newer, and $(PYTHON) is not: try make PYTHON=python3.12 ..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
	  { echo "$(PYTHON) cannot make an environment. On Debian and Ubuntu, as root: apt-get install python3-venv" >&2; exit 1; }
	@.venv/bin/python -m pip --version >/dev/null 2>&1 || \
	  { echo "making .venv (about 1 GB, a minute or two)"; $(PYTHON) -m venv --clear .venv; }
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@.venv/bin/python -m tipoff.studies.doctor
	@touch $@
