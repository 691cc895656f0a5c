# One target for each task. `make help` lists them.

SHELL := /bin/bash
.DEFAULT_GOAL := help
.PHONY: help install-deps build demo test test-all lint test-pure test-python38 test-pip test-docs test-install test-ros test-ros2 test-net simulate screenshots bench fuzz deb wheel clean

# ROS's Python: the system's, also where another python3 is the first on PATH. Where ROS 1 comes from another source
# (RoboStack, ROS One), it is the python3 on PATH that has rospy.
SYSTEM_ROS := $(wildcard /usr/lib/python3/dist-packages/rospy /opt/ros/noetic)
OTHER_ROS := $(if $(SYSTEM_ROS),,$(shell python3 -c 'import catkin_pkg, rospy, sys; print(sys.executable)' 2>/dev/null))
export PYTHON := $(or $(OTHER_ROS),/usr/bin/python3)
# On Ubuntu, ROS is not in the system's paths.
ROS_SETUP := if [ -e /opt/ros/noetic/setup.bash ]; then source /opt/ros/noetic/setup.bash; fi
BUILT := source build/devel/setup.bash
# `make test LINT=no` skips lint.
LINT := yes
# Without cached bytecode, Python compiles all modules again in each of the hundreds of programs of the tests.
unexport PYTHONDONTWRITEBYTECODE
# Some environments set it. Programs must flush what somebody waits for.
unexport PYTHONUNBUFFERED
# roslaunch imports distutils. Without this, Debian loads all of setuptools instead, which costs 0.3 s each time.
# Python 3.12 and later have no distutils of their own.
ifneq ($(wildcard /usr/lib/python3.*/distutils/core.py),)
test-docs test-install test-ros test-net: export SETUPTOOLS_USE_DISTUTILS := stdlib
endif
# No program here uses messages in these languages, and each message costs a process for each language.
build: export ROS_LANG_DISABLE := geneus:genlisp:gennodejs
# Selected tests without ROS.
PURE := test/pure
# Options of the bench.
BENCH :=
# Options of the simulator: make simulate SIMULATE="--seconds 600"
SIMULATE :=
# Options of the tests on a bad network.
NET ?=
# Seconds for each target: make fuzz FUZZ_SECONDS=600
export FUZZ_SECONDS ?= 60
# Selected targets: make fuzz FUZZ="box results"
FUZZ :=

help: ## list all targets
	@grep -E '^[a-z0-9-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z0-9-]+):.*## /  make \1\t/' | expand -t 24

# `make test` builds everything before it calls make again for the tests.
ifdef READY
install-deps build:
else
install-deps: ## install the required packages of the distribution
	@tools/install_deps

build: install-deps ## build into build/devel
	@mkdir -p build
	@$(ROS_SETUP); { cmake -S . -B build -DPYTHON_EXECUTABLE=$(PYTHON) -DCMAKE_INSTALL_PREFIX=$(CURDIR)/build/.install && \
	    cmake --build build -j2; } > build/build.log 2>&1 \
	  || { tail -n 30 build/build.log; echo "The build failed; all of its output is in build/build.log" >&2; exit 1; }
endif

# `make demo ROS=no` needs nothing but Python.
ifeq ($(ROS),no)
demo:
	@tools/demo_without_ros
else
demo: build ## run the dummy set-up on this machine; make demo ROS=no: without ROS
	@$(BUILT); rosrun roah_rsbb demo
endif

WITHOUT := $(if $(filter no,$(LINT)),--without lint)

test: build ## all tests, in parallel
	@tools/run_tests $(WITHOUT)

test-all: build ## also all random inputs, long rounds and fuzzing: about an hour
	@ROAH_TEST_ALL=yes NET="--all" tools/run_tests $(WITHOUT)
	@$(MAKE) --no-print-directory READY=yes fuzz

lint: install-deps ## ruff, mypy and catkin_lint; no committed logs or caches
	@tools/lint

test-pure: build ## tests without ROS
	@$(PYTHON) -m pytest -q $(PURE)

test-python38: install-deps ## the same on Python 3.8, if it is installed
	@tools/test_python38

test-pip: install-deps ## the wheels: a robot without ROS, its check, results
	@tools/test_pip_install

test-docs: build ## commands, links and examples of the documentation
	@$(BUILT); $(PYTHON) -m pytest -q test/docs

test-install: build ## the demonstration, from an install space
	@tools/test_install

test-ros: build ## tests of the nodes, each with its own ROS master
	@$(BUILT); tools/run_rostests

test-ros2: build ## the packages for teams with ROS 2, in an environment from PyPI
	@tools/test_ros2

test-net: build ## runs on a bad network (test/net/README.md); make test-net NET="--all --seed 2"
	@$(BUILT); $(PYTHON) -m pytest test/net $(NET)

simulate: ## the whole box with random troubles, in simulated time (test/simulator/README.md)
	@$(PYTHON) test/simulator/simulate.py $(SIMULATE)

screenshots: build ## the pictures in docs/images, from a fake core on a virtual display
	@$(BUILT); tools/make_screenshots

bench: build ## speed and load (bench/README.md), also in build/bench.json; make bench BENCH=--quick
	@$(BUILT); $(PYTHON) bench/run.py $(BENCH)

fuzz: build ## coverage-guided fuzzing (test/fuzz/README.md); make fuzz FUZZ_SECONDS=600
	@tools/fuzz $(FUZZ)

deb: build ## packages for this Debian or Ubuntu, in build/deb
	@packaging/make_deb

wheel: ## what pip installs without ROS, in build/wheel
	@packaging/make_wheel

clean: ## remove all build results
	rm -rf build
