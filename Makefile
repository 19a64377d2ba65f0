# What people and CI type. Everything is incremental: what is there already is not made again.
SHELL := /bin/bash
.DEFAULT_GOAL := build
JOBS ?= $(shell nproc)
CCACHE := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
# Without these ccache keeps nothing that is compiled with a precompiled header.
export CCACHE_SLOPPINESS ?= pch_defines,time_macros

rfmvo := build/release/host/rfmvo

.PHONY: build deb crash-test test-camera test-service test-tsan soak demo demo-offline reproduce test test-asan test-clang test-arm64 bench fuzz format format-check tidy packages clean

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

# A simulated aisle, live: a simulated reader on a TCP port and rendered frames at their own pace into rfmvod; then the
# evaluation and a report.
demo: build
	@$(MAKE) --no-print-directory demo/live/report.html
	@cat demo/live/evaluation.txt
	@echo "report: $(CURDIR)/demo/live/report.html"

# The same aisle from a journal, as fast as it goes.
demo-offline: build
	@$(MAKE) --no-print-directory demo/offline/report.html
	@cat demo/offline/evaluation.txt
	@echo "report: $(CURDIR)/demo/offline/report.html"

demo/frames/times.txt: $(rfmvo)
	@mkdir -p demo/frames
	$(rfmvo) simulate --force --scene aisle --seed 1 --out demo/frames/run.lcmlog --truth demo/frames/truth --frames-to demo/frames

demo/live/result.lcmlog: demo/frames/times.txt host/live_demo.sh build/release/firmware/rfmvod
	host/live_demo.sh build/release aisle 1 demo/frames demo/live

demo/live/report.html: demo/live/result.lcmlog
	$(rfmvo) evaluate $< --truth demo/live/truth --force --json demo/live/evaluation.json >demo/live/evaluation.txt
	$(rfmvo) report $< --truth demo/live/truth --force --out $@

demo/offline/result.lcmlog: demo/frames/times.txt
	@mkdir -p demo/offline
	$(rfmvo) replay demo/frames/run.lcmlog --out $@ --force --json demo/offline/replay.json

demo/offline/report.html: demo/offline/result.lcmlog
	$(rfmvo) evaluate $< --truth demo/frames/truth --replay-json demo/offline/replay.json \
	  --force --json demo/offline/evaluation.json >demo/offline/evaluation.txt
	$(rfmvo) report $< --truth demo/frames/truth --force --out $@

# The paper's evaluation as a page; IMAGES=DIR: on real frames, too.
reproduce: build
	$(rfmvo) reproduce --out reproduction $(if $(IMAGES),--images '$(IMAGES)')

test: build
	@ctest --test-dir build/release --output-on-failure -j 2

test-asan: packages
	@$(MAKE) --no-print-directory compile-asan
	@ctest --test-dir build/asan --output-on-failure -j 2

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

# Half an hour of rendered driving through the odometry: resident memory minute by minute. Takes about as long.
SOAK_MINUTES ?= 30
soak: build
	build/release/tests/rfmvo_odometry_soak --minutes $(SOAK_MINUTES)

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
	@build/fuzz/write_seeds build/fuzz/seeds
	@set -e; for target in llrp config journal request; do \
	  echo "$$target: $(FUZZ_SECONDS) s"; mkdir -p build/fuzz/corpus/$$target; \
	  [ $$target = llrp ] && seeds='$(wildcard ../shared/data/llrp/*/)' || seeds=; \
	  build/fuzz/$${target}_fuzz -max_total_time=$(FUZZ_SECONDS) -max_len=65536 -rss_limit_mb=4096 -verbosity=0 \
	    -artifact_prefix=build/fuzz/$$target- build/fuzz/corpus/$$target build/fuzz/seeds/$$target $$seeds; \
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
