# TIDES. `make help` lists the targets. Configurations live side by side: build/<CONFIG>/, CONFIG = release | debug | asan | tsan |
# coverage | clang | fuzz | arm (scripts/check_arm.sh).

CONFIG     ?= release
ifeq ($(origin CC),default) # make's own default is cc
CC         := $(if $(filter clang fuzz,$(CONFIG)),clang-14,gcc)
endif
PREFIX     ?= /usr/local
DESTDIR    ?=
BINDIR     ?= $(PREFIX)/bin
LIBDIR     ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DATADIR    ?= $(PREFIX)/share
MANDIR     ?= $(DATADIR)/man
PYTHON     ?= /usr/bin/python3
PKG_CONFIG ?= pkg-config
TIDES_SHARED ?= ../shared
export TIDES_SHARED

OUT     := build/$(CONFIG)
version  = $(shell sed -n 's/^\#define TIDES_VERSION_$(1) \([0-9]*\)/\1/p' include/tides/base.h)
MAJOR   := $(call version,MAJOR)
VERSION := $(MAJOR).$(call version,MINOR).$(call version,PATCH)

# -- flags -------------------------------------------------------------------------------------------------------------
# By pkg-config's names, which distributions share, but for HDF5's: Debian has one for each way to build it.
HDF5 := $(shell $(PKG_CONFIG) --exists hdf5-serial 2>/dev/null && echo hdf5-serial || echo hdf5)
# Pictures are the tool's alone: the library doesn't link cairo.
CLI_DEPS := cairo
DEPS := libpng libcjson $(HDF5) OpenCL zlib libdeflate libzstd liblz4 libwebp
# HDF5 1.12 gave some of its functions other meanings; this has all later versions mean what 1.10 did.
HDF5_API := $(if $(shell $(PKG_CONFIG) --atleast-version=1.12 $(HDF5) 2>/dev/null && echo later),-DH5_USE_110_API)
MISSING = $(shell for name in $(DEPS) $(CLI_DEPS) OpenEXR; do $(PKG_CONFIG) --exists $$name 2>/dev/null || echo $$name; done)
# Of OpenEXR's libraries its C core alone: the others are C++. Some distributions have the version in the name.
EXR_LIBS := $(filter -L% -lOpenEXRCore%,$(shell $(PKG_CONFIG) --libs OpenEXR 2>/dev/null))
EXR_LIBS += $(if $(filter -lOpenEXRCore%,$(EXR_LIBS)),,-lOpenEXRCore)
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wvla -Wundef -Wmissing-prototypes -Wstrict-prototypes -Wcast-qual \
            -Wpointer-arith -Wwrite-strings -Wconversion -Wno-sign-conversion
OPTIMISE_release := -O3 -g
OPTIMISE_clang   := -O3 -g
OPTIMISE_arm     := -O3 -g
OPTIMISE_debug   := -O0 -g3
OPTIMISE_asan    := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
# With sanitisers gcc also reports error texts that may be cut to fit: they are meant to be.
ifeq ($(CONFIG)$(findstring clang,$(CC)),asan)
OPTIMISE_asan += -Wno-format-truncation
endif
OPTIMISE_tsan    := -O1 -g -fsanitize=thread
# What ends up counted twice or not at all where two threads count at once isn't worth atomic counters (-pthread asks for them).
OPTIMISE_coverage := -O1 -g --coverage -fprofile-update=single
OPTIMISE_fuzz    := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
OPTIMISE := $(OPTIMISE_$(CONFIG))
# OpenEXR's headers use C11 anonymous structs: system headers, so that -Wpedantic leaves them alone.
TIDES_CPPFLAGS := -Iinclude -Ilib/base -Ilib/device -Ilib -I. $(shell $(PKG_CONFIG) --cflags $(DEPS) 2>/dev/null) \
                  $(HDF5_API) -DCL_TARGET_OPENCL_VERSION=120 -D_POSIX_C_SOURCE=200809L \
                  $(patsubst -I%,-isystem %,$(shell $(PKG_CONFIG) --cflags-only-I OpenEXR 2>/dev/null))
# -ffp-contract=off: host and device agree to the bit (kernels/numerics.h). -fno-trapping-math: the same bits, but gcc may work
# out what a choice doesn't take, as clang does anyway; else AVX2 gets no vectors of loops with choices (scripts/check_wide.sh).
TIDES_CFLAGS := -std=c99 $(OPTIMISE) -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -fvisibility=hidden -pthread $(WARNINGS)
CLI_CFLAGS   := $(shell $(PKG_CONFIG) --cflags-only-I $(CLI_DEPS) 2>/dev/null)
CLI_LDLIBS   := $(shell $(PKG_CONFIG) --libs $(CLI_DEPS) 2>/dev/null)
TIDES_LDLIBS := $(shell $(PKG_CONFIG) --libs $(DEPS) 2>/dev/null) $(EXR_LIBS) -lm -pthread
# CPPFLAGS, CFLAGS, LDFLAGS and LDLIBS are the user's, and come last so that they win.
COMPILE := $(CC) $(TIDES_CPPFLAGS) $(CPPFLAGS) $(TIDES_CFLAGS) $(CFLAGS)
LINK    := $(CC) $(TIDES_CFLAGS) $(CFLAGS) $(LDFLAGS)
WERROR  ?=
# gcc 12 for arm64 has an internal error in loops that look for the greatest by fmax, which tests have.
ifneq ($(filter aarch64-%,$(shell $(CC) -dumpmachine)),)
$(OUT)/tests/%.o: private COMPILE += -fno-tree-loop-vectorize
endif

# -- sources -----------------------------------------------------------------------------------------------------------
KERNELS  := $(wildcard kernels/*.h kernels/*.cl)
LIB_SRC  := $(wildcard lib/*/*.c lib/*/*/*.c)
CLI_SRC  := $(wildcard cli/*/*.c)
CLI_INCLUDES := $(addprefix -I,$(wildcard cli/*)) $(CLI_CFLAGS)
# By name, so that a sensor comes before its variants.
PRESETS  := $(addsuffix .json,$(sort $(basename $(wildcard share/presets/*.json))))
PAGE     := $(wildcard share/page/*)
LIB_OBJ  := $(LIB_SRC:%.c=$(OUT)/%.o) $(OUT)/kernels_embedded.o $(OUT)/presets_embedded.o $(OUT)/page_embedded.o
CLI_OBJ  := $(CLI_SRC:%.c=$(OUT)/%.o)
SUPPORT_OBJ := $(patsubst %.c,$(OUT)/%.o,$(wildcard tests/support/*.c))
TEST_SRC := $(wildcard tests/unit/test_*.c tests/derivatives/test_*.c tests/kernels/test_*.c tests/property/test_*.c \
                       tests/oracle/test_*.c)
# A simulator of the tests' own, which includes nothing of lib/ or kernels/, and the programs that hold the library against it.
ORACLE_OBJ := $(patsubst %.c,$(OUT)/%.o,$(filter-out tests/oracle/test_% tests/oracle/check_lost.c,$(wildcard tests/oracle/*.c)))
TESTS    := $(TEST_SRC:%.c=$(OUT)/%)
GOLDEN   := $(patsubst %.c,$(OUT)/%,$(wildcard tests/golden/test_*.c))

.PHONY: all
all: build/tides build/libtides.so ## Build the library and the command line tool (default)

# Flags that change rebuild what they changed (all but WERROR: it changes no object).
$(OUT)/.flags: FORCE
	$(if $(MISSING),$(error $(PKG_CONFIG) finds no $(MISSING): install their development packages (make deps), or set PKG_CONFIG_PATH))
	@mkdir -p $(@D)
	@echo '$(COMPILE)' | cmp -s - $@ || echo '$(COMPILE)' > $@
.PHONY: FORCE
FORCE:

$(OUT)/kernels_embedded.c: kernels/cl2c.sh $(KERNELS)
	@mkdir -p $(@D)
	sh kernels/cl2c.sh $(KERNELS) > $@.part && mv $@.part $@
$(OUT)/presets_embedded.c: kernels/cl2c.sh $(PRESETS)
	@mkdir -p $(@D)
	sh kernels/cl2c.sh -t td_preset_sources $(PRESETS) > $@.part && mv $@.part $@
$(OUT)/page_embedded.c: kernels/cl2c.sh $(PAGE)
	@mkdir -p $(@D)
	sh kernels/cl2c.sh -t td_page_sources $(PAGE) > $@.part && mv $@.part $@
$(OUT)/%.o: %.c $(OUT)/.flags
	@mkdir -p $(@D)
	$(COMPILE) $(WERROR) -MMD -MP -c $< -o $@
$(OUT)/cli/%.o: cli/%.c $(OUT)/.flags
	@mkdir -p $(@D)
	$(COMPILE) $(CLI_INCLUDES) $(WERROR) -MMD -MP -c $< -o $@
$(OUT)/tests/fuzz/fuzz_batch.o: tests/fuzz/fuzz_batch.c $(OUT)/.flags
	@mkdir -p $(@D)
	$(COMPILE) $(CLI_INCLUDES) $(WERROR) -MMD -MP -c $< -o $@
$(OUT)/%_embedded.o: $(OUT)/%_embedded.c $(OUT)/.flags
	$(COMPILE) $(WERROR) -c $< -o $@

$(OUT)/libtides.a: $(LIB_OBJ)
	@rm -f $@
	$(AR) rcs $@ $(LIB_OBJ)
$(OUT)/libtides.so.$(VERSION): $(LIB_OBJ)
	$(LINK) -shared -Wl,-soname,libtides.so.$(MAJOR) -Wl,--no-undefined -o $@ $(LIB_OBJ) $(TIDES_LDLIBS) $(LDLIBS)
	ln -sf libtides.so.$(VERSION) $(OUT)/libtides.so.$(MAJOR)
	ln -sf libtides.so.$(VERSION) $(OUT)/libtides.so
$(OUT)/tides: $(CLI_OBJ) $(OUT)/libtides.so.$(VERSION)
	$(LINK) -o $@ $(CLI_OBJ) -L$(OUT) -ltides -Wl,-rpath,'$$ORIGIN:$$ORIGIN/../lib' $(CLI_LDLIBS) $(TIDES_LDLIBS) $(LDLIBS)
# The links say which configuration was asked for last, whatever the files' ages are.
build/tides: $(OUT)/tides FORCE
	@ln -sfn $(OUT:build/%=%)/tides $@
build/libtides.so: $(OUT)/libtides.so.$(VERSION) FORCE
	@ln -sfn $(OUT:build/%=%)/libtides.so $@

# Tests reach internals, so they link the objects, not the shared library.
$(OUT)/tests/%: $(OUT)/tests/%.o $(SUPPORT_OBJ) $(OUT)/libtides.a
	$(LINK) -o $@ $< $(SUPPORT_OBJ) $(OUT)/libtides.a $(TIDES_LDLIBS) $(LDLIBS) -lcmocka

$(OUT)/tests/oracle/%: $(OUT)/tests/oracle/%.o $(ORACLE_OBJ) $(OUT)/libtides.a
	$(LINK) -o $@ $< $(ORACLE_OBJ) $(OUT)/libtides.a $(TIDES_LDLIBS) $(LDLIBS) -lcmocka

.PHONY: tests
tests: $(TESTS) $(GOLDEN) $(OUT)/tests/bench/own_bench ## Build the test programs

# Fuzz targets define LLVMFuzzerTestOneInput; libFuzzer has the main (tests/fuzz/README.md).
FUZZ     := $(patsubst %.c,$(OUT)/%,$(wildcard tests/fuzz/fuzz_*.c))
$(OUT)/tests/fuzz/fuzz_%: $(OUT)/tests/fuzz/fuzz_%.o $(OUT)/libtides.a
	$(LINK) -fsanitize=fuzzer -o $@ $(filter %.o,$^) $(filter %.a,$^) $(TIDES_LDLIBS) $(LDLIBS)
# Manifests are the tool's own.
$(OUT)/tests/fuzz/fuzz_batch: $(filter-out %/main.o,$(CLI_OBJ))
$(OUT)/tests/fuzz/fuzz_batch: TIDES_LDLIBS += $(CLI_LDLIBS)
# The library measured by itself (tests/bench/own): the tool's objects with another main. It holds frames against an object of its
# own, as fast as the compiler makes it on this very machine. Machines without AVX-512 have none.
LIMIT_OBJ    := $(patsubst %.c,$(OUT)/%.o,$(wildcard tests/bench/own/limit/*.c))
LIMIT_FLAGS  := -std=c99 -O3 -march=native -mprefer-vector-width=512 -funroll-loops -fno-math-errno -fno-trapping-math \
                -ffp-contract=fast -fPIC -fvisibility=hidden -pthread $(WARNINGS) -Wno-psabi
LIMIT_FITS   := $(shell echo | $(CC) -march=native -dM -E - 2>/dev/null | grep -c -e __AVX512F__ -e __AVX512BW__ -e __AVX512DQ__ -e __AVX512VL__)
$(OUT)/tests/bench/own/limit/%.o: tests/bench/own/limit/%.c $(OUT)/.flags
	@mkdir -p $(@D)
	$(CC) $(LIMIT_FLAGS) $(WERROR) -MMD -MP -c $< -o $@
$(OUT)/tests/bench/libtides-limit.so: $(if $(filter 4,$(LIMIT_FITS)),$(LIMIT_OBJ))
	$(if $(filter 4,$(LIMIT_FITS)),$(CC) -shared -pthread -o $@ $(LIMIT_OBJ) -lm,@echo 'no $@: it needs a machine with AVX-512')

OWN_OBJ := $(patsubst %.c,$(OUT)/%.o,$(wildcard tests/bench/own/*.c))
$(OUT)/tests/bench/own/%.o: tests/bench/own/%.c $(OUT)/.flags
	@mkdir -p $(@D)
	$(COMPILE) $(CLI_INCLUDES) $(WERROR) -MMD -MP -c $< -o $@
$(OUT)/tests/bench/own_bench: $(OWN_OBJ) $(filter-out %/main.o,$(CLI_OBJ)) $(OUT)/libtides.a | $(OUT)/tests/bench/libtides-limit.so
	$(LINK) -o $@ $(filter %.o,$^) $(OUT)/libtides.a -Wl,-rpath,'$$ORIGIN' $(CLI_LDLIBS) $(TIDES_LDLIBS) $(LDLIBS)

# Benchmarks of the test tree: programs that print their own table.
BENCH    := $(patsubst %.c,$(OUT)/%,$(wildcard tests/bench/bench_*.c))

.SECONDARY: # keep the tests' objects
-include $(LIB_OBJ:.o=.d) $(CLI_OBJ:.o=.d) $(LIMIT_OBJ:.o=.d) $(OWN_OBJ:.o=.d) $(TESTS:=.d) $(GOLDEN:=.d) $(FUZZ:=.d) $(BENCH:=.d) $(SUPPORT_OBJ:.o=.d) $(ORACLE_OBJ:.o=.d) $(OUT)/tests/oracle/check_lost.d

# -- set-up and demo ---------------------------------------------------------------------------------------------------
# The flags above are found when make starts, so whatever installs packages starts make afresh before it builds.
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
AGAIN = $(MAKE) --no-print-directory $(if $(filter -j% --jobserver-auth=%,$(MAKEFLAGS)),,-j$(JOBS))

.PHONY: deps deps-lint demo demo-built
deps: ## Install the Debian packages that are missing (root or sudo), and print the line for doing it by hand
	@sh scripts/deps.sh build
deps-lint: ## The same, with the tools that lint, check-clang and check-valgrind need
	@sh scripts/deps.sh lint
demo: ## Install what is missing, build, and simulate the demo scene into build/demo; V=1 shows the compiler's commands
	@sh scripts/deps.sh build -q
	@echo 'building the library and the tool: $(words $(LIB_OBJ) $(CLI_OBJ)) files (a minute or two the first time) ...'
	@$(AGAIN) $(if $(V),,-s) all
	@echo 'simulating the demo scene ...'
	@$(AGAIN) demo-built
demo-built:
	build/tides demo -o build/demo
	@ls -l build/demo

# -- checks ------------------------------------------------------------------------------------------------------------
RUN_TESTS = JOBS='$(JOBS)' CC='$(CC)' PYTHON='$(PYTHON)' PKG_CONFIG='$(PKG_CONFIG)' MAKE='$(MAKE)' CONFIG='$(CONFIG)' OUT='$(OUT)' \
            TIDES='$(CURDIR)/$(OUT)/tides' bash scripts/run_tests.sh $(OUT)/logs
# 77: something that the check needs isn't there, and it has said so.
OR_SKIPPED = { code=$$?; [ $$code = 77 ] || exit $$code; }
SCRIPTS := $(wildcard tests/cli/run.sh) scripts/python_tests.sh scripts/client_tests.sh scripts/check_readme.py \
           scripts/install_check.sh tests/unit/test_headers.sh tests/unit/test_lint.sh scripts/check_symbols.sh \
           scripts/check_wide.sh

.PHONY: check check-built check-readme check-readme-built check-golden check-golden-built check-asan check-asan-built \
        check-tsan check-tsan-built coverage coverage-built check-valgrind check-valgrind-built check-clang check-clang-built check-determinism check-determinism-built check-stability \
        check-all check-devices check-devices-built check-arm mutants install-check
check: ## Install what is missing, build without warnings, run every test
	@sh scripts/deps.sh check -q
	@$(AGAIN) WERROR=-Werror all tests
	@$(AGAIN) check-built
check-built:
	@README_QUICK=1 $(RUN_TESTS) $(SCRIPTS) $(GOLDEN) $(TESTS)
check-readme: ## Run every command and example of README.md, the slow ones too
	@sh scripts/deps.sh build -q
	@$(AGAIN) all
	@$(AGAIN) check-readme-built
check-readme-built:
	@CC='$(CC)' PYTHON='$(PYTHON)' MAKE='$(MAKE)' OUT='$(OUT)' TIDES='$(CURDIR)/$(OUT)/tides' $(PYTHON) scripts/check_readme.py
check-golden: ## Compare with other people's results in TIDES_SHARED=DIR (default ../shared)
	@sh scripts/deps.sh build -q
	@$(AGAIN) $(GOLDEN)
	@$(AGAIN) check-golden-built
check-golden-built:
	@$(RUN_TESTS) $(GOLDEN)
check-asan: ## Run the test programs and the CLI tests with the address and undefined behaviour sanitisers
	@sh scripts/deps.sh build -q
	@$(AGAIN) CONFIG=asan tests build/asan/tides
	@$(AGAIN) CONFIG=asan check-asan-built
# use_sigaltstack=0: PoCL's LLVM gives the thread that loads it a signal stack of its own, which ASan would unmap as its own.
# intercept_tls_get_addr=0: what stands before the thread-local data of libraries that PoCL loads isn't always the size that
# gcc 12's LeakSanitizer takes it for; its tracer then ends by signal 11.
# With PoCL alone, where other drivers are installed, too (check-devices installs Mesa's): what they lose isn't ours, and once
# they are unloaded has no name that could be left out.
POCL_ALONE := $(patsubst %,OCL_ICD_VENDORS=%,$(wildcard /etc/OpenCL/vendors/pocl.icd))
check-asan-built:
	@$(POCL_ALONE) ASAN_OPTIONS=detect_stack_use_after_return=1:use_sigaltstack=0:intercept_tls_get_addr=0:$$ASAN_OPTIONS \
	    LSAN_OPTIONS=suppressions=$(CURDIR)/scripts/lsan.supp:print_suppressions=0 TEST_TIMEOUT=3600 \
	    $(RUN_TESTS) $(wildcard tests/cli/run.sh) $(GOLDEN) $(TESTS)
# What several threads do at once: the tests that start some, and the library's own. PoCL and its LLVM aren't built for
# the sanitiser, which would take their locks for none: what they call isn't looked at (ignore_noninstrumented_modules), what
# ours does is. Forks of a process with threads go on to exec (die_after_fork).
TSAN := $(addprefix $(OUT)/tests/,unit/test_device_threads unit/test_output unit/test_device_fork unit/test_pool property/test_threads property/test_shared_work unit/test_steady_noise)
check-tsan: ## Run the tests that have threads with the thread sanitiser
	@sh scripts/deps.sh build -q
	@$(AGAIN) CONFIG=tsan check-tsan-built
check-tsan-built: $(TSAN)
	@for threads in 2 4; do TIDES_THREADS=$$threads \
	    TSAN_OPTIONS=ignore_noninstrumented_modules=1:die_after_fork=0:exitcode=66:$$TSAN_OPTIONS $(RUN_TESTS) $(TSAN) || exit; done
# All tests, the tool's and Python's too; faults*.sh among them go through the paths of errors.
coverage: ## Which lines and branches of lib/ the tests reach, at least 90 % and 80 %: build/coverage/report/index.html
	@sh scripts/deps.sh coverage -q
	@$(AGAIN) CONFIG=coverage tests build/coverage/tides build/coverage/libtides.so.$(VERSION)
	@$(AGAIN) CONFIG=coverage coverage-built
coverage-built:
	@find $(OUT) -name '*.gcda' -delete
	@GCOV_ERROR_FILE=/dev/null README_QUICK=1 TEST_TIMEOUT=3600 $(RUN_TESTS) tests/cli/run.sh scripts/python_tests.sh $(GOLDEN) $(TESTS); \
	    tests=$$?; OUT='$(OUT)' JOBS='$(JOBS)' sh scripts/coverage.sh || $(OR_SKIPPED); exit $$tests
# Those of the unit tests that neither load an OpenCL driver nor kill themselves.
VALGRIND := $(filter $(addprefix $(OUT)/tests/unit/test_,base comparator crossing event_sort events events_read image_exr \
            image_png model_dir npy npz path path_datasets pickle pyrepr run run_open scene scene_gltf scene_gltf_refused scene_hdf5 scene_packed scene_ply \
            scene_sog scene_spz trajectory zip),$(TESTS))
check-valgrind: ## Run unit tests and a small simulation on the reference device under valgrind
	@sh scripts/deps.sh lint -q
	@$(AGAIN) all tests
	@$(AGAIN) check-valgrind-built
check-valgrind-built:
	@TEST_TIMEOUT=1800 VALGRIND_PROGRAMS='$(VALGRIND)' $(RUN_TESTS) scripts/check_valgrind.sh
check-clang: ## Build with clang without warnings and run the test programs
	@sh scripts/deps.sh lint -q
	@$(AGAIN) CONFIG=clang WERROR=-Werror tests build/clang/tides
	@$(AGAIN) CONFIG=clang check-clang-built
check-clang-built:
	@$(RUN_TESTS) $(TESTS) $(GOLDEN)
check-determinism: ## One hash for each run of tides bench determinism, built by gcc and by clang, and from Python
	@sh scripts/deps.sh lint -q
	@$(AGAIN) all
	@$(AGAIN) CONFIG=clang build/clang/tides
	@$(AGAIN) check-determinism-built
check-determinism-built:
	@TIDES='$(CURDIR)/$(OUT)/tides' OTHERS='$(CURDIR)/build/clang/tides' OUT='$(OUT)' PYTHON='$(PYTHON)' \
	    sh scripts/check_determinism.sh
check-devices: ## Small runs on Oclgrind: reference-f32's events to the bit, no data race, no access outside a buffer
	@sh scripts/deps.sh lint -q
	@$(AGAIN) all
	@$(AGAIN) check-devices-built
check-devices-built:
	@TIDES='$(CURDIR)/$(OUT)/tides' sh scripts/check_devices.sh || $(OR_SKIPPED)
check-arm: all ## As root: cross-build for arm64; tests, small runs and the wheel under qemu, the same hashes; PARTS="hashes wheel tests pocl"
	@NATIVE='$(CURDIR)/$(OUT)/tides' PYTHON='$(PYTHON)' JOBS=$(JOBS) nice -n 10 bash scripts/check_arm.sh $(PARTS) || $(OR_SKIPPED)
mutants: ## Change formulas of the kernels and the solver, one at a time: a test must notice each
	@sh scripts/deps.sh build -q
	@MAKE='$(MAKE)' JOBS=$(JOBS) PYTHON='$(PYTHON)' sh scripts/mutants.sh
# In the order of what is found soonest; the long sweeps come last.
CHECKS := lint check check-golden check-clang check-asan check-tsan check-valgrind install-check check-readme check-determinism check-devices \
          mutants fuzz fuzz-hdf5 faults coverage check-lost check-arm check-stability
check-all: ## All checks that there are, one after the other, and a line for each: hours
	@MAKE='$(MAKE)' sh scripts/check_all.sh $(CHECKS)
check-stability: ## tides bench stability, all rows: an hour
	@sh scripts/deps.sh build -q
	@$(AGAIN) all
	build/tides bench stability -o build/stability
install-check: all ## Install into an empty folder, build a program there with pkg-config, run it, uninstall
	@MAKE='$(MAKE)' CC='$(CC)' PKG_CONFIG='$(PKG_CONFIG)' CONFIG='$(CONFIG)' sh scripts/install_check.sh

.PHONY: lint lint-built format fuzz fuzz-built fuzz-hdf5 fuzz-hdf5-built faults faults-built bench bench-built
lint: ## clang-format, clang, clang-tidy, cppcheck, the kernels through clang, and what arrows.txt and docs say of the whole
	@sh scripts/deps.sh lint -q
	@$(AGAIN) lint-built
lint-built:
	@TIDY_FLAGS='$(TIDES_CPPFLAGS) $(CLI_INCLUDES) -std=c99' WARNINGS='$(WARNINGS)' JOBS=$(JOBS) PYTHON='$(PYTHON)' sh scripts/lint.sh
format: ## Rewrite C files and kernels in the style of .clang-format
	clang-format-14 -i $$(sh scripts/sources.sh)
FUZZ_SECONDS ?= 30
fuzz: ## Run each target of tests/fuzz with libFuzzer and sanitisers for FUZZ_SECONDS=30
	@sh scripts/deps.sh lint -q
	@$(AGAIN) CONFIG=fuzz fuzz-built
fuzz-built: $(FUZZ)
	@failed=0; for target in $(FUZZ); do sh scripts/fuzz.sh $$target $(FUZZ_SECONDS) || failed=1; done; exit $$failed
MUTATIONS ?= 20000
fuzz-hdf5: ## Damage our own HDF5 files MUTATIONS=20000 times
	@sh scripts/deps.sh build -q
	@$(AGAIN) all $(OUT)/tests/property/test_hdf5_mutations
	@$(AGAIN) fuzz-hdf5-built
fuzz-hdf5-built:
	TIDES_MUTATIONS=$(MUTATIONS) $(OUT)/tests/property/test_hdf5_mutations
faults: ## Let every write, every allocation and every call of OpenCL fail in turn: half an hour
	@sh scripts/deps.sh build -q
	@$(AGAIN) all
	@$(AGAIN) faults-built
faults-built:
	@mkdir -p $(OUT)/logs
	@rm -f $(OUT)/logs/faults.txt
	@TIDES_FAULTS=all TIDES_FAULTS_COUNTS='$(CURDIR)/$(OUT)/logs/faults.txt' TIDES='$(CURDIR)/$(OUT)/tides' \
	    bash tests/cli/run.sh $(wildcard tests/cli/faults*.sh); code=$$?; cat $(OUT)/logs/faults.txt; exit $$code
bench: ## Run the benchmarks of tests/bench, the library's stages and how its cost grows too: hours; build/bench/index.html
	@sh scripts/deps.sh build -q
	@$(AGAIN) bench-built
bench-built: $(BENCH) $(OUT)/tests/bench/own_bench
	@set -e; for program in $(BENCH); do $$program; done
	$(OUT)/tests/bench/own_bench all -o build/bench

# -- Python package ----------------------------------------------------------------------------------------------------
.PHONY: live-example
live-example: all ## A camera follows a ball by its own events for 10 s: build/track_ball.png
	TIDES_LIBRARY='$(CURDIR)/$(OUT)/libtides.so' PYTHONPATH='$(CURDIR)/python_ctypes' PYTHONDONTWRITEBYTECODE=1 \
	    $(PYTHON) python_ctypes/examples/track_ball.py build/track_ball.png

.PHONY: check-lost check-lost-built
check-lost: ## Events against an oracle's own on TIDES_TRIALS=500 random scenes of the hard kinds: an hour
	@sh scripts/deps.sh build -q
	@$(AGAIN) check-lost-built
check-lost-built: $(OUT)/tests/oracle/check_lost
	@POCL_CACHE_DIR='$(CURDIR)/build/pocl-cache' $(OUT)/tests/oracle/check_lost

.PHONY: check-live
check-live: all ## Live for long: that example keeps its ball in view for 10 s, and the process doesn't grow; minutes
	TIDES_LIVE_SECONDS=10 TIDES_LIBRARY='$(CURDIR)/$(OUT)/libtides.so' PYTHONPATH='$(CURDIR)/python_ctypes' PYTHONDONTWRITEBYTECODE=1 \
	    $(PYTHON) -m pytest -q -s -p no:cacheprovider tests/python/package/test_live.py -k example

.PHONY: python
python: ## Make python_ctypes/tides/_api.py anew from the headers
	CC='$(CC)' $(PYTHON) python_ctypes/generate.py

PAGES    := $(OUT)/share
# -- manual ------------------------------------------------------------------------------------------------------------
.PHONY: docs docs-built
docs: ## The manual as static HTML: guide, C and Python interface, commands: build/docs/index.html
	@sh scripts/deps.sh docs -q
	@$(AGAIN) all
	@$(AGAIN) docs-built
docs-built: all $(PAGES)/.made
	@PYTHON='$(PYTHON)' VERSION='$(VERSION)' TIDES_LIBRARY='$(CURDIR)/$(OUT)/libtides.so' sh scripts/docs/make.sh '$(CURDIR)/build/docs' $(PAGES)

# -- install -----------------------------------------------------------------------------------------------------------
HEADERS := $(wildcard include/tides/*.h)
# Man pages and completions are what the tool says of itself; below $(OUT)/share as below $(DATADIR).
CMAKE_FILES := tides-config.cmake tides-config-version.cmake
COMMANDS := $(patsubst cli/commands/cmd_%.c,%,$(wildcard cli/commands/cmd_*.c))
MAN1     := tides.1 $(COMMANDS:%=tides-%.1)
$(PAGES)/.made: $(OUT)/tides
	@mkdir -p $(PAGES)
	$(OUT)/tides help --man > $(PAGES)/tides.1
	$(OUT)/tides help --man run > $(PAGES)/tides-run.5
	set -e; for command in $(COMMANDS); do $(OUT)/tides help --man $$command > $(PAGES)/tides-$$command.1; done
	$(OUT)/tides help --bash > $(PAGES)/tides.bash
	$(OUT)/tides help --zsh > $(PAGES)/_tides
	@touch $@
.PHONY: install uninstall dist clean
install: all $(PAGES)/.made ## Install below PREFIX=/usr/local (also DESTDIR, BINDIR, LIBDIR, INCLUDEDIR, DATADIR, MANDIR)
	install -d '$(DESTDIR)$(MANDIR)/man1' '$(DESTDIR)$(MANDIR)/man5' '$(DESTDIR)$(DATADIR)/bash-completion/completions' \
	    '$(DESTDIR)$(DATADIR)/zsh/site-functions'
	install -m 644 $(MAN1:%=$(PAGES)/%) '$(DESTDIR)$(MANDIR)/man1'
	install -m 644 $(PAGES)/tides-run.5 '$(DESTDIR)$(MANDIR)/man5'
	install -m 644 $(PAGES)/tides.bash '$(DESTDIR)$(DATADIR)/bash-completion/completions/tides'
	install -m 644 $(PAGES)/_tides '$(DESTDIR)$(DATADIR)/zsh/site-functions/_tides'
	install -d '$(DESTDIR)$(BINDIR)' '$(DESTDIR)$(LIBDIR)/pkgconfig' '$(DESTDIR)$(INCLUDEDIR)/tides'
	install -m 755 $(OUT)/tides '$(DESTDIR)$(BINDIR)/tides'
	install -m 755 $(OUT)/libtides.so.$(VERSION) '$(DESTDIR)$(LIBDIR)/libtides.so.$(VERSION)'
	ln -sf libtides.so.$(VERSION) '$(DESTDIR)$(LIBDIR)/libtides.so.$(MAJOR)'
	ln -sf libtides.so.$(MAJOR) '$(DESTDIR)$(LIBDIR)/libtides.so'
	install -m 644 include/tides.h '$(DESTDIR)$(INCLUDEDIR)/tides.h'
	install -m 644 $(HEADERS) '$(DESTDIR)$(INCLUDEDIR)/tides'
	install -d '$(DESTDIR)$(DATADIR)/tides/presets'
	install -m 644 $(PRESETS) '$(DESTDIR)$(DATADIR)/tides/presets'
	sed -e "s|@up@|$$(realpath -m --relative-to='$(LIBDIR)/pkgconfig' '$(PREFIX)')|" -e 's|@version@|$(VERSION)|' \
	    -e 's|@libdir@|$(patsubst $(PREFIX)/%,$${prefix}/%,$(LIBDIR))|' \
	    -e 's|@includedir@|$(patsubst $(PREFIX)/%,$${prefix}/%,$(INCLUDEDIR))|' lib/tides.pc.in \
	    > '$(DESTDIR)$(LIBDIR)/pkgconfig/tides.pc'
	chmod 644 '$(DESTDIR)$(LIBDIR)/pkgconfig/tides.pc'
	install -d '$(DESTDIR)$(LIBDIR)/cmake/tides'
	for file in $(CMAKE_FILES); do \
	    sed -e "s|@up@|$$(realpath -m --relative-to='$(LIBDIR)/cmake/tides' '$(PREFIX)')|" -e 's|@version@|$(VERSION)|' \
	        -e 's|@major@|$(MAJOR)|' -e 's|@libdir@|$(patsubst $(PREFIX)/%,$${tides_prefix}/%,$(LIBDIR))|' \
	        -e 's|@includedir@|$(patsubst $(PREFIX)/%,$${tides_prefix}/%,$(INCLUDEDIR))|' lib/$$file.in \
	        > '$(DESTDIR)$(LIBDIR)/cmake/tides'/$$file; \
	    chmod 644 '$(DESTDIR)$(LIBDIR)/cmake/tides'/$$file; \
	done
uninstall: ## Remove what install put there
	rm -f '$(DESTDIR)$(BINDIR)/tides' '$(DESTDIR)$(LIBDIR)/pkgconfig/tides.pc' '$(DESTDIR)$(INCLUDEDIR)/tides.h' \
	    $(CMAKE_FILES:%='$(DESTDIR)$(LIBDIR)/cmake/tides/%') \
	    $(foreach end,so so.$(MAJOR) so.$(VERSION),'$(DESTDIR)$(LIBDIR)/libtides.$(end)') \
	    $(patsubst include/%,'$(DESTDIR)$(INCLUDEDIR)/%',$(HEADERS)) \
	    $(patsubst share/%,'$(DESTDIR)$(DATADIR)/tides/%',$(PRESETS)) \
	    $(MAN1:%='$(DESTDIR)$(MANDIR)/man1/%') '$(DESTDIR)$(MANDIR)/man5/tides-run.5' \
	    '$(DESTDIR)$(DATADIR)/bash-completion/completions/tides' '$(DESTDIR)$(DATADIR)/zsh/site-functions/_tides'
	-rmdir '$(DESTDIR)$(INCLUDEDIR)/tides' '$(DESTDIR)$(LIBDIR)/cmake/tides' '$(DESTDIR)$(DATADIR)/tides/presets' '$(DESTDIR)$(DATADIR)/tides'
dist: ## Pack the committed sources: build/tides-VERSION.tar.gz
	@mkdir -p build
	git archive --format=tar.gz --prefix=tides-$(VERSION)/ -o build/tides-$(VERSION).tar.gz HEAD
clean: ## Remove build/
	rm -rf build

# -- packages ----------------------------------------------------------------------------------------------------------
.PHONY: wheel wheel-built check-wheel deb check-deb
# The wheel has in it what its library and tool link: archives where the system has them, copies of the shared libraries of the rest
# (python_ctypes/stage.py). The older kind of run path (DT_RPATH) is the one that goes for what those libraries link, too.
STAGE := $(OUT)/wheel
WHEELS ?= build/python
WHEEL_LIBS = $(shell sh scripts/archives.sh '$(CC)' $(TIDES_LDLIBS) $(LDLIBS) -lsz -laec)
WHEEL_CLI_LIBS = $(shell sh scripts/archives.sh '$(CC)' $(shell $(PKG_CONFIG) --static --libs $(CLI_DEPS)))
WHEEL_LINK = $(LINK) -s -Wl,--as-needed,--exclude-libs,ALL,--disable-new-dtags,-rpath,'$$ORIGIN'
wheel: all $(PAGES)/.made ## Pack the Python package with library, tool and all that these link: WHEELS=build/python
	@$(AGAIN) wheel-built
wheel-built: # scripts/check_arm.sh does this alone where compilers are emulated
	rm -rf $(STAGE) && mkdir -p $(STAGE)
	for name in streams random; do $(COMPILE) $(WERROR) -c python_ctypes/$$name.c -o $(OUT)/$$name.o || exit 1; done
	$(WHEEL_LINK) -shared -Wl,-soname,libtides.so.$(MAJOR),--no-undefined,--wrap=stdout,--wrap=stderr -Wl,-Map=$(OUT)/libtides.map \
	    -o $(STAGE)/libtides.so.$(MAJOR) $(LIB_OBJ) $(OUT)/streams.o -Wl,--start-group $(WHEEL_LIBS) -Wl,--end-group
	$(WHEEL_LINK) -Wl,-Map=$(OUT)/tides.map -o $(STAGE)/tides $(CLI_OBJ) $(OUT)/random.o $(STAGE)/libtides.so.$(MAJOR) \
	    -Wl,--start-group $(WHEEL_CLI_LIBS) $(WHEEL_LIBS) -Wl,--end-group
	$(PYTHON) python_ctypes/stage.py $(STAGE) $(OUT)/libtides.map $(OUT)/tides.map
	rm -f '$(WHEELS)'/tides-*.whl
	TIDES_WHEEL='$(CURDIR)/$(STAGE)' TIDES_PAGES='$(CURDIR)/$(PAGES)' \
	    $(PYTHON) -m pip wheel -q --no-build-isolation --no-deps -w '$(WHEELS)' ./python_ctypes
	@ls '$(WHEELS)'/*.whl
check-wheel: wheel ## As root: the wheel in chroots of Debian 12 and 13 that have python3 and pip alone (debootstrap); minutes
	sh scripts/check_wheel.sh '$(WHEELS)'/tides-*.whl

# The tool is linked anew: in Debian's folders it needs no run path. What it doesn't use is no dependency.
DEB := build/deb
deb: all $(PAGES)/.made ## Pack libtides0, libtides-dev, tides and python3-tides for this release of Debian: build/deb/*.deb
	rm -rf $(DEB) && mkdir -p $(DEB)/root
	@$(MAKE) --no-print-directory -s install DESTDIR='$(CURDIR)/$(DEB)/root' PREFIX=/usr LIBDIR=/usr/lib/$$(gcc -print-multiarch)
	$(LINK) -Wl,--as-needed -o $(DEB)/root/usr/bin/tides $(CLI_OBJ) -L$(OUT) -ltides $(CLI_LDLIBS) $(TIDES_LDLIBS) $(LDLIBS)
	VERSION=$(VERSION) MAJOR=$(MAJOR) sh scripts/deb.sh $(DEB)/root $(DEB)
	@rm -rf $(DEB)/root && ls $(DEB)/*.deb
check-deb: deb ## As root: the packages in a chroot (debootstrap): apt installs them, they run, a purge leaves nothing
	sh scripts/check_deb.sh $(DEB)

.PHONY: help
help: ## Print this
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  %-16s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))
	@echo "Variables: CONFIG=release|debug|asan|clang  PREFIX DESTDIR  TIDES_SHARED=DIR  CC CFLAGS LDFLAGS  JOBS=N  V=1 (demo)"
