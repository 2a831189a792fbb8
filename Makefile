# The two commands are `make demo` and `make test`; both work on a fresh Debian or Ubuntu machine with cargo.
#
# Compiling the dependencies is most of the time, so the steps of `make test` share them: clippy, for all sets of
# features, and rustdoc use one set of checked crates, tests one set of compiled ones (the dev profile: optimised, with
# debug assertions). Benches are checked by clippy, not linked: fifteen programs with nothing to run.

.DEFAULT_GOAL := help
.NOTPARALLEL:

CARGO ?= cargo

.PHONY: help
help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-13s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

.PHONY: demo
demo: system-packages ## play the demo in a window, or without a display render it to demo.png
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then \
		$(CARGO) run --locked --release -- view; \
	else \
		$(CARGO) run --locked --release -- render demo: -o demo.png \
		&& echo "There is no display to open a window on: the demo is in $(CURDIR)/demo.png"; \
	fi

.PHONY: test
test: test-packages tools fmt-check lint features-docs-deny tests doctests ## everything that CI runs

# Checking the crate and documenting it is work of one processor, three times over; building cargo-deny is that of the
# other one.
.PHONY: features-docs-deny
features-docs-deny:
	@$(MAKE) --no-print-directory deny & deny=$$!; \
	$(MAKE) --no-print-directory features docs; status=$$?; \
	wait $$deny && exit $$status

.PHONY: check
check: fmt-check ## formatting and clippy of the program: while you write
	$(CARGO) clippy --locked --lib --bins -- -D warnings

.PHONY: fmt
fmt: ## format the code
	$(CARGO) fmt

.PHONY: lint
lint: ## clippy on all targets, warnings are errors
	$(CARGO) clippy --locked --all-targets -- -D warnings

# Sets of features besides the whole: the core, as fuzz/ has it, and what a machine with a card and no screen needs.
# `--examples` as in `docs`.
.PHONY: features
features: ## clippy on the core alone, and on all but the window
	$(CARGO) clippy --locked --no-default-features --features fuzzing --lib --bins --examples -- -D warnings
	$(CARGO) clippy --locked --no-default-features --features bench --lib --bins --examples -- -D warnings

# `--examples` documents nothing (there are none): it makes cargo choose dependency features as for tests, so that the
# crates clippy has just checked are used instead of being checked a second time with fewer features.
.PHONY: docs
docs: ## rustdoc, warnings are errors
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --no-deps --lib --examples

# An installed cargo-deny is used; otherwise one is built here, unoptimised and without debug information (a minute on
# two cores; the check itself takes a second). Advisories are apart: their database is a download, and a new entry must
# not fail an old commit.
TOOLS := $(CURDIR)/target/tools
DENY = PATH="$$PATH:$(TOOLS)/bin" $(CARGO) deny --locked
.PHONY: deny
deny: cargo-deny ## licences, sources and bans of the dependencies
	$(DENY) check licenses bans sources

.PHONY: advisories
advisories: cargo-deny ## known vulnerabilities of the dependencies (downloads the advisory database)
	$(DENY) check advisories

.PHONY: cargo-deny
cargo-deny:
	@PATH="$$PATH:$(TOOLS)/bin" $(CARGO) deny --version >/dev/null 2>&1 \
		|| CARGO_PROFILE_DEV_DEBUG=0 $(CARGO) install --locked --debug --quiet --root $(TOOLS) cargo-deny

.PHONY: slurm-test
slurm-test: ## the Slurm job file on a slurmctld with two slurmd (root; packages slurmctld slurmd slurm-client munge)
	$(CARGO) build --locked
	scripts/slurm-test.sh target/debug/pointreel

.PHONY: fuzz
fuzz: ## fuzz readers, verbs and window for ten minutes (SECONDS=3600 for longer, SEEDS=folders of files to begin with)
	scripts/fuzz.sh $(or $(SECONDS),600) $(SEEDS)

# In `make test` a dozen calls of each kind fail per command; all of them take most of an hour.
.PHONY: faults
faults: ## each allocation, opening, reading and writing of some twenty commands fails once
	POINTREEL_FAULTS=all $(CARGO) test --locked --test faults

.PHONY: bench
bench: ## run the criterion benches (benches/README.md)
	$(CARGO) bench --locked --benches

# Not part of `make test`: it downloads a part of Chromium (26 MB), for one library.
.PHONY: second-driver
second-driver: ## run the tests of pictures on a second Vulkan driver, SwiftShader
	scripts/second-driver.sh

.PHONY: soak
soak: ## play 10,000 frames that do not fit into the memory for them, and record the program's memory
	$(CARGO) bench --locked --bench play -- soak

.PHONY: fmt-check
fmt-check:
	$(CARGO) fmt --check

# Tests run on this machine alone: of its kernels the levels below its processor's are not compiled.
tests properties doctests faults: export RUSTC_WORKSPACE_WRAPPER ?= $(CURDIR)/scripts/rustc-for-this-machine.sh

# Properties are tried on the same random cases every time, so that a commit which has passed goes on passing; others are
# looked for by `make properties`.
.PHONY: tests
tests: export PROPTEST_RNG_SEED ?= 4
tests:
	scripts/run-tests.sh

.PHONY: properties
properties: export PROPTEST_CASES ?= 2000
properties: ## try properties on many new random cases (PROPTEST_CASES=20000 for more)
	$(CARGO) test --locked --lib --tests --no-fail-fast

.PHONY: doctests
doctests:
	$(CARGO) test --locked --doc

.PHONY: system-packages
system-packages:
	@scripts/install-system-packages.sh

.PHONY: test-packages
test-packages:
	@scripts/install-system-packages.sh --with-tests

# rustup's minimal profile has neither.
.PHONY: tools
tools:
	@$(CARGO) --version >/dev/null || { echo "cargo is missing: install Rust from https://rustup.rs"; exit 1; }
	@$(CARGO) fmt --version >/dev/null 2>&1 || rustup component add rustfmt
	@$(CARGO) clippy --version >/dev/null 2>&1 || rustup component add clippy
