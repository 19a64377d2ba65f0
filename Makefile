# What people and CI type. Everything is incremental: what is there already is not made again.
SHELL := /bin/bash
.DEFAULT_GOAL := build
JOBS ?= $(shell nproc)
CCACHE := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
# Tests that are only a matter of numbers, and slow under the sanitizers.
ASAN_EXCLUDE ?= scenario|reference

rfmvo := build/release/host/rfmvo

.PHONY: build demo demo-files demo-live reproduce test test-asan test-clang test-arm64 bench fuzz format format-check tidy packages clean

packages:
	@cmake/install-packages.sh

build: packages
	@$(MAKE) --no-print-directory compile-release

# compile-PRESET: configures once, then builds what changed.
.PHONY: compile-release compile-asan compile-clang
compile-release compile-asan compile-clang: compile-%: build/%/build.ninja
	@cmake --build build/$* -j $(JOBS)

build/%/build.ninja: CMakePresets.json
	@cmake --preset $* $(CCACHE)
	@touch $@

# A simulated aisle from raw events to a report.
demo: build
	@$(MAKE) --no-print-directory demo-files
	@cat demo/evaluation.txt
	@echo "report: $(CURDIR)/demo/report.html"

# The same aisle, live: a simulated reader over TCP and rendered frames into rfmvod, then the report.
demo-live: build
	@$(MAKE) --no-print-directory demo-live-files
	@cat demo/live/evaluation.txt
	@echo "report: $(CURDIR)/demo/live/report.html"

.PHONY: demo-live-files
demo-live-files: demo/frames/times.txt
	@host/live_demo.sh build/release aisle 1 demo/frames demo/live
	@$(rfmvo) evaluate demo/live/result.lcmlog --truth demo/live/truth --force --json demo/live/evaluation.json \
	  >demo/live/evaluation.txt
	@$(rfmvo) report demo/live/result.lcmlog --truth demo/live/truth --force --out demo/live/report.html

demo/frames/times.txt: $(rfmvo)
	@mkdir -p demo/frames
	$(rfmvo) simulate --force --scene aisle --seed 1 --out demo/frames/run.lcmlog --truth demo/frames/truth --frames-to demo/frames

demo-files: demo/report.html

demo/run.lcmlog: $(rfmvo)
	@mkdir -p demo
	$(rfmvo) simulate --force --scene aisle --seed 1 --out demo/run.lcmlog --truth demo/truth

demo/result.lcmlog: demo/run.lcmlog $(rfmvo)
	$(rfmvo) replay demo/run.lcmlog --out demo/result.lcmlog --json demo/replay.json --force

demo/evaluation.txt: demo/result.lcmlog
	$(rfmvo) evaluate demo/result.lcmlog --truth demo/truth --replay-json demo/replay.json \
	  --force --json demo/evaluation.json >demo/evaluation.tmp
	@mv demo/evaluation.tmp $@

demo/report.html: demo/evaluation.txt
	$(rfmvo) report demo/result.lcmlog --truth demo/truth --force --out demo/report.html

# The paper's evaluation as a page; IMAGES=DIR: on real frames, too.
reproduce: build
	$(rfmvo) reproduce --out reproduction $(if $(IMAGES),--images '$(IMAGES)')

test: build
	@ctest --test-dir build/release --output-on-failure -j 2

test-asan: packages
	@$(MAKE) --no-print-directory compile-asan
	@ctest --test-dir build/asan --output-on-failure -j 2 -LE '$(ASAN_EXCLUDE)'

test-clang:
	@cmake/install-packages.sh clang
	@$(MAKE) --no-print-directory compile-clang
	@ctest --test-dir build/clang --output-on-failure -j 2

# The kernels and their tests, cross-compiled, under qemu-user; and their instructions per cell.
test-arm64:
	@cmake/install-packages.sh g++-aarch64-linux-gnu googletest qemu-user
	@cmake -S tests/arm64 -B build/arm64 -G Ninja --toolchain $(CURDIR)/cmake/aarch64.cmake $(CCACHE) >/dev/null
	@cmake --build build/arm64 -j $(JOBS)
	@ctest --test-dir build/arm64 --output-on-failure

bench: build
	build/release/tests/rfmvo_benchmarks

# What comes from outside, thrown at the codec, the journal reader and the configuration for so many seconds each.
FUZZ_SECONDS ?= 30
fuzz:
	@cmake/install-packages.sh clang libclang-rt-14-dev
	@cmake -S tests/fuzz -B build/fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ $(CCACHE) >/dev/null
	@cmake --build build/fuzz -j $(JOBS)
	@set -e; for target in llrp config journal; do \
	  echo "$$target: $(FUZZ_SECONDS) s"; mkdir -p build/fuzz/corpus/$$target; \
	  build/fuzz/$${target}_fuzz -max_total_time=$(FUZZ_SECONDS) -max_len=65536 -rss_limit_mb=4096 -verbosity=0 \
	    -artifact_prefix=build/fuzz/$$target- build/fuzz/corpus/$$target $(wildcard ../shared/data/llrp/malformed); \
	done

sources = $(shell git ls-files '*.cpp' '*.hpp')

format:
	@cmake/install-packages.sh clang-format
	clang-format -i $(sources)

format-check:
	@cmake/install-packages.sh clang-format
	clang-format --dry-run -Werror $(sources)

tidy: build
	@cmake/install-packages.sh clang-tidy
	clang-tidy --quiet -p build/release $(filter firmware/%.cpp host/%.cpp,$(sources))

# The Python environment and downloaded packages stay.
clean:
	rm -rf build/release build/asan build/clang build/arm64 build/fuzz demo reproduction
