# What people and CI type. Everything is incremental: what is there already is not made again.
SHELL := /bin/bash
.DEFAULT_GOAL := build
JOBS ?= $(shell nproc)
CCACHE := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
# Tests that are only a matter of numbers, and slow under the sanitizers.
ASAN_EXCLUDE ?= scenario|reference

rfmvo := build/release/host/rfmvo

.PHONY: build deb crash-test test-camera test-service test-tsan demo demo-files demo-live reproduce test test-asan test-clang test-arm64 bench fuzz format format-check tidy packages clean

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
	@$(rfmvo) evaluate demo/live/result.lcmlog --truth demo/live/truth --json demo/live/evaluation.json \
	  >demo/live/evaluation.txt
	@$(rfmvo) report demo/live/result.lcmlog --truth demo/live/truth --out demo/live/report.html

demo/frames/times.txt: $(rfmvo)
	@mkdir -p demo/frames
	$(rfmvo) simulate --scene aisle --seed 1 --out demo/frames/run.lcmlog --truth demo/frames/truth --frames-to demo/frames

demo-files: demo/report.html

demo/run.lcmlog: $(rfmvo)
	@mkdir -p demo
	$(rfmvo) simulate --scene aisle --seed 1 --out demo/run.lcmlog --truth demo/truth

demo/result.lcmlog: demo/run.lcmlog $(rfmvo)
	$(rfmvo) replay demo/run.lcmlog --out demo/result.lcmlog --json demo/replay.json

demo/evaluation.txt: demo/result.lcmlog
	$(rfmvo) evaluate demo/result.lcmlog --truth demo/truth --replay-json demo/replay.json \
	  --json demo/evaluation.json >demo/evaluation.tmp
	@mv demo/evaluation.tmp $@

demo/report.html: demo/evaluation.txt
	$(rfmvo) report demo/result.lcmlog --truth demo/truth --out demo/report.html

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

# Debian packages of the box and of the tools, in build/deb; lintian finds no errors.
deb: build
	@cmake/install-packages.sh dpkg-dev lintian
	@rm -rf build/deb && cpack --config build/release/CPackConfig.cmake -B build/deb >/dev/null && rm -rf build/deb/_CPack_Packages
	@lintian --fail-on error build/deb/*.deb
	@ls -l build/deb/*.deb

# The packages' life (install, upgrade, purge), and the service as systemd runs it, in a container. Root only.
test-service: deb
	@cmake/install-packages.sh systemd-container
	@tests/boot/package_test.sh build/deb/rfmvo-firmware_*.deb
	@tests/boot/service_test.sh build/deb/rfmvo-firmware_*.deb

# kill -9 at random moments under load, so many times.
CRASHES ?= 200
crash-test: build
	RFMVO_CRASHES=$(CRASHES) build/release/tests/rfmvo_box_tests --gtest_filter='Crash.*'

# rfmvod on a real V4L2 driver, in a guest machine with Debian's kernel.
test-camera: packages
	@cmake/install-packages.sh qemu-system-x86 busybox-static kmod cpio v4l-utils
	@$(MAKE) --no-print-directory build/release/build.ninja
	@cmake --build build/release -j $(JOBS) --target rfmvod
	@rm -rf build/camera && mkdir -p build/camera && cp build/release/firmware/rfmvod build/camera/
	@tests/boot/guest.sh build/camera tests/boot/camera_guest.sh

# The threads of edges and daemon under ThreadSanitizer.
test-tsan: packages
	@cmake -S tests/tsan -B build/tsan -G Ninja $(CCACHE) >/dev/null
	@cmake --build build/tsan -j $(JOBS)
	@ctest --test-dir build/tsan --output-on-failure

# What comes from outside, thrown at the codec, the journal reader, the configuration and its door for so many seconds each.
FUZZ_SECONDS ?= 30
fuzz:
	@cmake/install-packages.sh clang libclang-rt-14-dev
	@cmake -S tests/fuzz -B build/fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ $(CCACHE) >/dev/null
	@cmake --build build/fuzz -j $(JOBS)
	@set -e; for target in llrp config journal request; do \
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
	rm -rf build/release build/asan build/clang build/arm64 build/fuzz build/tsan build/deb demo reproduction
