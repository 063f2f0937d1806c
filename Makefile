# The few commands of this project. `make demo` and `make test` set up everything they need.

PYTHON ?= python3
VENV   := .venv
RUN    := $(VENV)/bin/python
READY  := $(VENV)/.ready
# what only tests of reports need
REPORTS := $(VENV)/.reports
# what only pictures of the cell need
MESHES := $(VENV)/.meshes
# ROS 1 and ROS 2 have packages of equal names: an environment each, which has all of $(VENV) as well
ROS1   := $(VENV)-ros1
ROS2   := $(VENV)-ros2

# what builds the documentation's site
SITE   := $(VENV)-site

# what looks at what is installed
AUDIT  := $(VENV)-audit
LOCKS  := $(wildcard requirements*.lock)

# tests of the core that need no example
CORE    = $(addprefix tests/,model config operators results journal campaign/plan plugins \
    test_extensions.py)

of_ros  = $(wildcard $(addsuffix /test_ros$(1)*.py,tests/packages/ros tests/packages/ros/* tests/packages/ros_in_process))

.PHONY: demo test whole alone check format docs site pictures comparison tasks bench stress judged shipped foreign audit sbom locks dist clean

## run the published experiment: 26 mutants, five rounds, in physics
demo: $(READY)
	$(VENV)/bin/mutabot -C examples/paper run --only @published.txt
	$(VENV)/bin/mutabot -C examples/paper results
	$(RUN) benchmarks/paper_scores.py examples/paper

## lint, types and the tests, but for those of `make whole`
test: check $(ROS1)/.ready $(ROS2)/.ready
	$(RUN) -m pytest -n 2 --dist worksteal
	$(ROS1)/bin/python -m pytest -n 2 --dist worksteal $(call of_ros,1) tests/model/values/test_messages.py || test $$? -eq 5  # all skipped
	$(ROS2)/bin/python -m pytest -n 2 --dist worksteal $(call of_ros,2) || test $$? -eq 5

## the tests that take long: the reference engine on every fact, the corpus, clusters, browsers, many nodes, many runs
whole: $(READY) $(REPORTS) $(ROS1)/.ready $(ROS2)/.ready
	$(RUN) -m pytest -n 3 --dist worksteal -m whole --durations 60
	$(ROS1)/bin/python -m pytest -n 2 --dist worksteal -m whole $(call of_ros,1) tests/model/values/test_messages.py || test $$? -eq 5  # all skipped
	$(ROS2)/bin/python -m pytest -n 2 --dist worksteal -m whole $(call of_ros,2) || test $$? -eq 5
	$(MAKE) alone

## tests of the core, on a wheel from which the packages beside it are deleted
alone: $(READY)
	$(RUN) tools/core_alone.py -n 2 --dist worksteal $(CORE)

## lint and types only
check: $(READY) $(REPORTS)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy

## lay out the code as the project does
format: $(READY)
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .

## write the generated pages of docs/ again
docs: $(READY)
	$(RUN) tools/make_docs.py
	$(RUN) tools/make_conventional_page.py
	cd benchmarks && ../$(RUN) -m comparison.page
	$(RUN) benchmarks/tasks.py
	$(RUN) tools/make_design_page.py

## build the documentation as a site, in site/; what would be a dead link there is an error
site: $(SITE)/.ready
	rm -rf site
	$(SITE)/bin/sphinx-build --quiet --fresh-env --fail-on-warning --keep-going -b html \
	    -c tools/site -d $(SITE)/doctrees . site
	@echo "open site/index.html"

## draw the pictures of the cell and of the report in docs/img again, without a screen
pictures: $(READY) $(REPORTS) $(MESHES)
	MUJOCO_GL=$${MUJOCO_GL:-osmesa} $(RUN) tools/make_pictures.py
	MUJOCO_GL=$${MUJOCO_GL:-osmesa} $(RUN) tools/hero_picture.py
	MUJOCO_GL=$${MUJOCO_GL:-osmesa} $(RUN) tools/example_pictures.py
	$(RUN) tools/make_report_pictures.py

## compare the families of operators on the examples (of the largest a tenth of the mutants), and write
## docs/comparison.md from it
comparison: $(READY)
	cd benchmarks && for name in paper pick_and_place scales; do \
	    test $$name = pick_and_place && sample="--sample 10%" || sample=""; \
	    ../$(RUN) -m comparison.run ../examples/$$name --rounds 5 $$sample > ../$(VENV)/$$name.json || exit; \
	done
	cd benchmarks && ../$(RUN) -m comparison.page \
	    $(foreach name,paper pick_and_place scales,$(name)=../$(VENV)/$(name).json)

## run the robot mutants and conventional ones of each kind of task against every test, and write docs/tasks.md
## from it; that takes hours of processor time
tasks: $(READY)
	for name in paper pick_and_place tracking palletising dispensing handover assembly bin_picking; do \
	    $(RUN) benchmarks/tasks.py run $$name --robot 60 --conventional 60 || exit; \
	done
	$(RUN) benchmarks/tasks.py

## measure, in an hour: the cost of intercepted calls and of engines, simulation speed, seeds of each example
bench: $(READY)
	$(RUN) benchmarks/interception.py
	$(RUN) benchmarks/instrumentation.py
	$(RUN) benchmarks/cell_speed.py
	$(RUN) benchmarks/cell_physics.py
	$(RUN) benchmarks/paper_seeds.py
	$(RUN) benchmarks/suggested_checks.py --seeds 50 paper
	$(RUN) benchmarks/engines.py --page docs/engines.md
	$(RUN) benchmarks/example_seeds.py pick_and_place 100
	$(RUN) benchmarks/example_seeds.py tracking 30
	$(RUN) benchmarks/example_seeds.py palletising 5
	$(RUN) benchmarks/example_seeds.py dispensing 100
	$(RUN) benchmarks/example_seeds.py handover 30
	$(RUN) benchmarks/example_seeds.py assembly 30
	$(RUN) benchmarks/example_seeds.py bin_picking 30
	$(RUN) benchmarks/stories_judged.py
	$(RUN) benchmarks/stories_judged.py --bare --sample 60
	$(RUN) benchmarks/html_report.py

## slow: kill the controller at 30 random moments and finish by resuming; stop campaigns on hardware at 1,000 moments;
## both engines on every mutant of the examples; both engines against plain pytest; ten thousand mutants; ten thousand
## tests; 200 campaigns in a row; 20 whose tests start processes, on each example with some; 400 campaigns with a test
## that fails at random; --since after 40 edits
stress: $(READY) $(ROS1)/.ready $(ROS2)/.ready
	$(RUN) benchmarks/kill_and_resume.py --kills 30
	$(RUN) benchmarks/hardware_stops.py --held 1000 --ended 30
	$(RUN) benchmarks/differential.py
	$(RUN) benchmarks/judged.py
	$(ROS1)/bin/python benchmarks/judged.py ros1
	$(ROS2)/bin/python benchmarks/judged.py ros2
	$(RUN) benchmarks/ten_thousand.py
	$(RUN) benchmarks/suite_length.py
	$(RUN) benchmarks/campaigns_in_a_row.py --count 200
	$(RUN) benchmarks/processes_in_a_row.py --examples scales
	for ros in $(ROS1) $(ROS2); do \
	    test ! -x $$ros/bin/python || { \
	        $$ros/bin/python benchmarks/processes_in_a_row.py --examples ros1 ros2 --selection published.txt && \
	        $$ros/bin/python benchmarks/processes_in_a_row.py --examples ros1 ros2 --count 2 --rounds 3 \
	            --families robot,middleware,conventional,text; } || exit; \
	done
	$(RUN) benchmarks/flaky_campaigns.py
	$(RUN) benchmarks/since_edits.py --edits 40

## slow: every verdict on the corpus of tests/suites and on mutants of the examples, by both engines, against plain
## pytest on program text that was edited
judged: $(READY) $(ROS1)/.ready $(ROS2)/.ready
	$(RUN) benchmarks/judged.py
	$(ROS1)/bin/python benchmarks/judged.py ros1
	$(ROS2)/bin/python benchmarks/judged.py ros2

## compare the shipped vocabularies with the packages they describe, which get a virtual environment of their own
shipped: $(VENV)-shipped/.ready
	$(VENV)-shipped/bin/python tools/check_shipped.py --strict

## slow: the recipes of docs/recipes as projects of their own: init, check, run, and mutants made by hand; guards
## and hardware mode with vendors' client libraries
foreign: $(VENV)-shipped/.ready
	$(VENV)-shipped/bin/python benchmarks/foreign_programs.py
	$(VENV)-shipped/bin/python -m pytest tests/packages/hardware/test_vendors.py -m "whole or not whole"

## ask the index whether weaknesses are known of what the lock files name
audit: $(AUDIT)/.ready
	$(AUDIT)/bin/pip-audit --strict --no-deps --disable-pip $(foreach lock,$(LOCKS),-r $(lock))

## list what this environment consists of as a CycloneDX bill of materials, in dist/
sbom: $(READY) $(AUDIT)/.ready
	mkdir -p dist
	$(AUDIT)/bin/cyclonedx-py environment --no-validate --pyproject pyproject.toml --output-reproducible --output-format JSON \
	    --output-file dist/mutabot.cdx.json $(RUN)
	@echo "dist/mutabot.cdx.json"

## find the hashes of the lock files again, after a version in one of them was changed
locks: $(AUDIT)/.ready
	$(AUDIT)/bin/python tools/locks.py

## build a source distribution of what git tracks, and the wheel from that, in dist/; publishes nothing
dist: $(READY)
	rm -rf dist/*.tar.gz dist/*.whl
	$(RUN) -m hatchling build -t sdist
	$(RUN) -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation -w dist dist/*.tar.gz

$(VENV)-shipped/.ready: tools/shipped.txt pyproject.toml
	$(PYTHON) -m venv $(VENV)-shipped
	$(VENV)-shipped/bin/python -m pip install --quiet --disable-pip-version-check -e . -r tools/shipped.txt
	@touch $@

$(READY): requirements.lock pyproject.toml tools/setup.sh
	PYTHON=$(PYTHON) VENV=$(VENV) sh tools/setup.sh
	@touch $@

# What only tests need: the main job is set up without it.
$(REPORTS): $(READY) requirements-reports.lock tools/schemas.py
	$(RUN) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
	    -r requirements-reports.lock
	$(RUN) tools/schemas.py
	@touch $@

$(MESHES): $(READY) requirements-pictures.lock
	$(RUN) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
	    -r requirements-pictures.lock
	@touch $@

# The environment of the project makes it: that one knows where Debian keeps venv.
$(SITE)/.ready: requirements-site.lock | $(READY)
	$(RUN) -m venv --clear $(SITE)
	$(SITE)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
	    -r requirements-site.lock
	@touch $@

$(AUDIT)/.ready: requirements-audit.lock | $(READY)
	$(RUN) -m venv --clear $(AUDIT)
	$(AUDIT)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	    --only-binary :all: -r requirements-audit.lock
	@touch $@

# Debian's rospy. Where it is not installed, its tests skip themselves.
$(ROS1)/.ready: $(READY) tools/beside.py tools/see_rospy.py
	@$(RUN) tools/beside.py $(ROS1)
	@$(ROS1)/bin/python tools/see_rospy.py
	@touch $@

# Where there are no wheels of ROS 2, its tests skip themselves.
$(ROS2)/.ready: $(READY) tools/beside.py requirements-ros2.lock
	@$(RUN) tools/beside.py $(ROS2)
	@$(RUN) -m pip --python $(ROS2)/bin/python install --quiet --disable-pip-version-check --no-deps \
	    --require-hashes --only-binary :all: --no-binary empy -r requirements-ros2.lock || echo "no wheels of ROS 2 for this Python and machine: its tests skip themselves"
	@touch $@

clean:
	rm -rf $(VENV) $(VENV)-shipped $(ROS1) $(ROS2) $(SITE) $(AUDIT) site examples/*/.mutabot .mypy_cache .ruff_cache .pytest_cache
