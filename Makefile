# The commands of README.md: CMake and the program do the work. `make help` lists them.
#
#   make deps figures            from a bare machine to the figures
#   make figures ENGINE=cem      the same with another engine: exact, restitution, cem
ENGINE ?= exact
BUILD := build
# The component element method takes a hundred times as long as the others: a smaller ensemble.
MEMBERS := $(if $(filter cem,$(ENGINE)),--members 8)
FIGURES := $(BUILD)/figures$(if $(filter-out exact,$(ENGINE)),/$(ENGINE))
ifeq ($(filter $(ENGINE),exact restitution cem),)
$(error ENGINE must be exact, restitution or cem, got $(ENGINE))
endif
FUZZ_SECONDS ?= 60
COMMAND_SECONDS ?= 120
JOBS := $(shell nproc 2>/dev/null || echo 2)

# What the program and the figures need, and nothing else: `make bare` holds it against a bare system.
PACKAGES := g++ cmake ninja-build libeigen3-dev libcli11-dev nlohmann-json3-dev gnuplot-nox librsvg2-bin fonts-dejavu-core
# What the tests need beside these.
CHECK_PACKAGES := git doctest-dev libboost-dev libmpfr-dev python3 python3-jsonschema python3-yaml clang llvm lld libclang-rt-dev \
  locales clang-tidy cppcheck gcovr valgrind pandoc chromium groff-base pkgconf zsh fish doxygen \
  pybind11-dev python3-dev python3-numpy libhdf5-dev hdf5-tools libsndfile1-dev
# What the report is made of, and what its PDF is set with.
PAPER_PACKAGES := python3 pandoc latexmk texlive-latex-base texlive-latex-recommended lmodern
# What the bench's references and peers are made of.
BENCH_PACKAGES := libboost-dev libsundials-dev libsiconos-kernel-dev libsiconos-numerics-dev
# What sweeps on several machines are tested with.
CLUSTER_PACKAGES := python3 slurm-wlm munge parallel rsync
# What WebAssembly is compiled, run and tried with, and what is compiled for other processors.
WASM_PACKAGES := emscripten nodejs node-acorn node-typescript python3 chromium firefox-esr
MACHINE_PACKAGES := g++-aarch64-linux-gnu g++-riscv64-linux-gnu g++-s390x-linux-gnu qemu-user
# What a bare system is made with.
BARE_PACKAGES := debootstrap debian-archive-keyring gpgv

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: help deps deps-bare deps-bench deps-check deps-cluster deps-paper deps-same-bits deps-wasm build install figures verify paper docs test bench bench-record bench-wasm \
  stress stress-results stress-commands check check-long check-all cluster-check bare fuzz kills lint sanitize coverage mutation same-bits wasm wasm-check reference archive clean

help:  ## list the targets
	@echo "impact-damper: make TARGET..."
	@sed -n 's/^\([a-z-]*\):[^#]*## */\1\t/p' $(firstword $(MAKEFILE_LIST)) | while IFS="$$(printf '\t')" read -r name what; do \
	  printf '  %-13s %s\n' "$$name" "$$what"; done

deps:  ## install what is missing (Debian); elsewhere say what is wanted
	@.ci/install $(PACKAGES)

deps-check:  ## the same for the tests: make deps-check check
	@.ci/install $(PACKAGES) $(CHECK_PACKAGES)

deps-bench:  ## the same for the bench: its peers and its higher precision
	@.ci/install $(PACKAGES) $(BENCH_PACKAGES)
	@$(alone) rm -f $(BUILD)/build.ninja  # CMake looks anew for what has come

deps-cluster:  ## the same for sweeps on a cluster: make deps-cluster cluster-check
	@.ci/install $(PACKAGES) $(CLUSTER_PACKAGES)

deps-paper:  ## the same for the report: make deps-paper paper
	@.ci/install $(PACKAGES) $(PAPER_PACKAGES)

deps-same-bits:  ## the same for other compilers and processors: make deps-same-bits same-bits
	@.ci/install $(PACKAGES) $(CHECK_PACKAGES) $(WASM_PACKAGES) $(MACHINE_PACKAGES)

deps-wasm:  ## the same for the package for browsers and node: make deps-wasm wasm
	@.ci/install $(PACKAGES) $(WASM_PACKAGES)

deps-bare:  ## the same for a bare system to try both commands of README.md in: make deps-bare bare
	@.ci/install $(BARE_PACKAGES)

# What comes first in a recipe that works in $(BUILD): one at a time in this folder, also where a killed one's
# children still work. The lock goes with the last process that inherits descriptor 9. Where it is held, no make
# may be called for the same folder: it would wait for the one that waits for it.
define alone
exec 9<.; \
if command -v flock >/dev/null && ! flock -n 9; then \
  echo "make $@: waiting for another make in this folder to end" >&2; \
  flock 9; \
fi;
endef

# Made by a recipe, not while the Makefile is read: `make deps figures` has no CMake before its first half.
$(BUILD)/build.ninja:
	@$(alone) [ -f $@ ] || cmake --preset release

# Turns on BUILD_TESTING or BENCH in $(BUILD), for good: nothing that is there is compiled again, and `make figures`
# has nothing to do afterwards. Where it cannot be, because packages are missing, it does not stay on: `make figures`
# does without.
define with
{ [ -f $(BUILD)/build.ninja ] && grep -qx "$(1):BOOL=ON" $(BUILD)/CMakeCache.txt; } || \
cmake --preset release -D$(1)=ON || { \
  echo "make $@: cannot be set up; make $(2) installs what it needs" >&2; \
  cmake --preset release -D$(1)=OFF >/dev/null; \
  exit 1; \
};
endef
with_tests = $(call with,BUILD_TESTING,deps-check)
with_bench = $(call with,BENCH,deps-bench)

build: $(BUILD)/build.ninja  ## compile the program
	@$(alone) cmake --build $(BUILD) --target impact-damper

# DESTDIR, for who makes packages, is put before PREFIX by CMake.
PREFIX ?= /usr/local
export DESTDIR
ifeq ($(filter /%,$(PREFIX)),)
$(error PREFIX must be an absolute path, got $(PREFIX))
endif
install: $(BUILD)/build.ninja  ## install program, data, man page, completions, library and Python module (PREFIX=/usr/local, DESTDIR=)
	@$(alone) cmake --build $(BUILD) --target installed || exit; \
	cmake --install $(BUILD) --prefix "$(PREFIX)" >$(BUILD)/install.log || { cat $(BUILD)/install.log; exit 1; }; \
	echo "Installed: $(DESTDIR)$(PREFIX)/bin/impact-damper; all files are listed in $(BUILD)/install_manifest.txt"

figures: $(BUILD)/build.ninja  ## simulate, compute and draw all figures (ENGINE=exact|restitution|cem)
	@$(alone) \
	trap 'exec 9<&-; if command -v flock >/dev/null; then flock . true; fi; \
	  left=$$(cmake --build $(BUILD) --target figures-$(ENGINE) -- -n | grep -c "^\["); \
	  echo "make $@: interrupted, at most $$left steps are left: the same command goes on from here" >&2; \
	  exit 130' INT; \
	touch $(BUILD)/figures.begin; \
	cmake --build $(BUILD) --target figures-$(ENGINE) || exit; \
	if [ $(BUILD)/figures-$(ENGINE).stamp -nt $(BUILD)/figures.begin ]; then \
	  echo "Figures drawn: $(FIGURES)"; else echo "Figures are up to date: $(FIGURES)"; fi

verify: $(BUILD)/build.ninja  ## hold the results against the paper, claim by claim (ENGINE= as for figures)
	@$(alone) cmake --build $(BUILD) --target runs-$(ENGINE) || exit; \
	$(BUILD)/src/impact-damper verify --runs $(BUILD)/runs/$(ENGINE) $(MEMBERS) \
	  --catalogue figures/catalogue.json -o $(BUILD)/verdicts-$(ENGINE).json

# Where there is a compiler for it, the report's page has a damper to play with, and checks.
WASM := $(if $(shell command -v em++),$(BUILD)/wasm)
paper: $(if $(WASM),wasm) $(BUILD)/build.ninja  ## the report, build/paper/report.pdf and report.html, from the exact engine's results
	@$(alone) cmake --build $(BUILD) --target figures-exact runs-exact || exit; \
	$(BUILD)/src/impact-damper verify --catalogue figures/catalogue.json -o $(BUILD)/verdicts-exact.json \
	  >$(BUILD)/verdicts-exact.txt || { cat $(BUILD)/verdicts-exact.txt; exit 1; }; \
	echo "Setting the report"; \
	paper/report/make.py $(BUILD) $(WASM:%=--wasm %) && echo "The report: $(BUILD)/paper/report.pdf and report.html"

docs:  ## reference documentation of the library's headers, build/docs/html (doxygen)
	@$(alone) mkdir -p $(BUILD)/docs && OUTPUT=$(BUILD)/docs doxygen docs/Doxyfile && \
	echo "The reference documentation: $(BUILD)/docs/html/index.html"

# CTest's label `long` is on what takes about ten seconds or more (tests/CMakeLists.txt). What a test needs that another
# one makes, a fixture, is made in each of the two calls.
run_tests = $(alone) $(with_tests) cmake --build $(BUILD) && ctest --test-dir $(BUILD) --output-on-failure -j $(JOBS)

test:  ## build, and run the quick tests: all without the label long
	@$(run_tests) -LE '^long$$'

bare:  ## run both commands of README.md on a bare Debian 12, or SUITE=trixie (as root, a quarter of an hour); before every release
	@$(alone) SUITE=$(SUITE) tests/bare/run $(BUILD)/bare

fuzz:  ## fuzz every reader of files, two at a time, for FUZZ_SECONDS=60 each
	@$(alone) tests/fuzz/run $(FUZZ_SECONDS) $(BUILD)/count

bench:  ## measure run time beside error (ten to twenty minutes), print and draw it
	@$(alone) $(with_bench) cmake --build $(BUILD) --target bench

bench-record: bench  ## the same, and keep page, figures and results in bench/results/
	@$(alone) mkdir -p bench/results && cp $(BUILD)/bench/results.md $(BUILD)/bench/results.json $(BUILD)/bench/time_error.svg $(BUILD)/bench/cost.svg bench/results/

bench-wasm: wasm $(BUILD)/build.ninja  ## what a decay takes in node, beside the library (a minute)
	@$(alone) $(with_tests) cmake --build $(BUILD) --target decay_time || exit; \
	bench/wasm.py $(BUILD)/bench-build/decay_time $(BUILD)/wasm/package data/scenes/nu2-e06.json data/scenes/nu2-e04.json

stress:  ## what the engines must stand: a million random scenes, aimed ones, 4000 of each kind against the oracle (half an hour)
	@$(alone) $(with_tests) cmake --build $(BUILD) --target stress

stress-results:  ## the same, and keep page and figures in tests/stress/
	@$(alone) $(with_tests) cmake --build $(BUILD) --target stress-results

stress-commands:  ## random scenes of every command that simulates, under the sanitizers, for COMMAND_SECONDS=120 each
	@$(alone) cmake --preset sanitize -B $(BUILD)/sanitize >/dev/null && \
	cmake --build $(BUILD)/sanitize --target impact-damper && \
	tests/stress/commands.py $(BUILD)/sanitize/src/impact-damper $(BUILD)/stress-commands --seconds $(COMMAND_SECONDS)

kills:  ## kill run, series, drawing, verify and make figures 110 times (minutes)
	@$(alone) $(with_tests) cmake --build $(BUILD) --target kills

check: test  ## make test; then the exact engine's figures, and its results held against the paper (five minutes after the build)
	@$(MAKE) --no-print-directory figures verify ENGINE=exact

check-long:  ## what make check leaves out: the tests with the label long, the other engines' figures (some twenty minutes)
	@$(run_tests) -L '^long$$'
	@for engine in restitution cem; do \
	  $(MAKE) --no-print-directory figures verify ENGINE=$$engine || exit 1; \
	done

check-all: check check-long  ## make check, then make check-long: every test, every engine

cluster-check: $(BUILD)/build.ninja  ## sweeps by the scripts of examples/cluster/: GNU parallel, and a real Slurm that is started here (minutes)
	@$(alone) cmake --build $(BUILD) --target impact-damper || exit; \
	for check in parallel slurm; do \
	  PYTHONPATH=tests tests/cluster/$$check.py $(BUILD)/src/impact-damper $(BUILD)/cluster-check/$$check || exit; \
	done

lint: $(BUILD)/build.ninja  ## clang-tidy and cppcheck over the sources: no finding (minutes)
	@$(alone) cmake --build $(BUILD) --target impact_damper_provenance -- --quiet
	@tests/checks/lint.py $(BUILD)

sanitize: $(BUILD)/build.ninja  ## the quick tests once more, under clang's address and undefined-behaviour sanitizers (a quarter of an hour)
	@$(alone) cmake --build $(BUILD) --target impact-damper || exit; \
	SIMULATED_BY=$(abspath $(BUILD)/src/impact-damper) tests/checks/sanitize sanitize $(BUILD)/sanitize

coverage:  ## the same with counters; then which lines of the library they ran: at least 95 % of them (twice the time)
	@$(alone) tests/checks/sanitize count $(BUILD)/count && tests/checks/coverage $(BUILD)/count

mutation:  ## plant faults in a copy of the library, one by one: do the fast tests notice? (an hour; goes on where stopped)
	@$(alone) nice tests/mutation/mutate.py --folder $(BUILD)/mutation

same-bits:  ## the same bytes from other compilers, processors, WebAssembly and strange surroundings (a quarter of an hour)
	@$(alone) $(with_tests) cmake --build $(BUILD) --target same-bits

wasm:  ## the library for browsers and node, as an npm package, and pages to play with a damper and to try one's own: build/wasm/
	@$(alone) mkdir -p $(BUILD) && cmake -S . -B $(BUILD)/wasm -G Ninja --toolchain src/toolchains/wasm.cmake -DCMAKE_BUILD_TYPE=MinSizeRel \
	  >$(BUILD)/wasm.log || { cat $(BUILD)/wasm.log; echo "make $@: make deps-wasm installs what it needs" >&2; exit 1; }; \
	cmake --build $(BUILD)/wasm --target pages && echo "The package: $$(ls $(BUILD)/wasm/impact-damper-*.tgz), the pages: $(BUILD)/wasm/damper.html and own.html"

wasm-check: wasm $(BUILD)/build.ninja  ## the pages work, and the package's run files are the program's, in node and in a browser (minutes)
	@$(alone) cmake --build $(BUILD) --target figures-exact runs-exact || exit; \
	tests/wasm/check.py $(BUILD)

reference: $(BUILD)/build.ninja  ## renew what people cite: data/reference/, docs/report.md, and the outputs in README.md and paper/
	@$(alone) paper/renew $(BUILD)

archive:  ## write what is deposited: sources, reference data, figures and report, as they are committed
	@paper/archive
	@$(MAKE) --no-print-directory paper
	@$(alone) paper/archive $(BUILD)

clean:  ## remove all that was built
	@$(alone) rm -rf --one-file-system $(BUILD)
