# TIDES. `make help` lists the targets. Configurations live side by side: build/<CONFIG>/, CONFIG = release | debug | asan.

CONFIG     ?= release
CC         ?= gcc
PREFIX     ?= /usr/local
DESTDIR    ?=
PYTHON     ?= /usr/bin/python3
PKG_CONFIG ?= pkg-config
TIDES_SHARED ?= ../shared
export TIDES_SHARED

OUT     := build/$(CONFIG)
version  = $(shell sed -n 's/^\#define TIDES_VERSION_$(1) \([0-9]*\)/\1/p' include/tides/base.h)
MAJOR   := $(call version,MAJOR)
VERSION := $(MAJOR).$(call version,MINOR).$(call version,PATCH)

# -- flags -------------------------------------------------------------------------------------------------------------
HDF5 := $(shell $(PKG_CONFIG) --exists hdf5-serial 2>/dev/null && echo hdf5-serial || echo hdf5)
DEPS := libpng libcjson $(HDF5) OpenCL zlib
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wvla -Wundef -Wmissing-prototypes -Wstrict-prototypes -Wcast-qual \
            -Wpointer-arith -Wwrite-strings -Wconversion -Wno-sign-conversion
OPTIMISE_release := -O3 -g
OPTIMISE_debug   := -O0 -g3
OPTIMISE_asan    := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
OPTIMISE := $(OPTIMISE_$(CONFIG))
# OpenEXR's headers use C11 anonymous structs: system headers, so that -Wpedantic leaves them alone.
CPPFLAGS += -Iinclude -Ilib/base -Ilib -I. $(shell $(PKG_CONFIG) --cflags $(DEPS) 2>/dev/null) -DCL_TARGET_OPENCL_VERSION=120 \
            -D_POSIX_C_SOURCE=200809L $(patsubst -I%,-isystem %,$(shell $(PKG_CONFIG) --cflags-only-I OpenEXR 2>/dev/null))
# -ffp-contract=off: host and device agree to the bit (DESIGN, Numbers).
CFLAGS   += -std=c99 $(OPTIMISE) -ffp-contract=off -fno-math-errno -fPIC -fvisibility=hidden -pthread $(WARNINGS) $(WERROR)
LDLIBS   += $(shell $(PKG_CONFIG) --libs $(DEPS) 2>/dev/null) -lOpenEXRCore -lm -pthread
WERROR   ?=

# -- sources -----------------------------------------------------------------------------------------------------------
KERNELS  := $(wildcard kernels/*.h kernels/*.cl)
LIB_SRC  := $(wildcard lib/*/*.c)
CLI_SRC  := $(wildcard cli/*.c)
LIB_OBJ  := $(LIB_SRC:%.c=$(OUT)/%.o) $(OUT)/kernels_embedded.o
CLI_OBJ  := $(CLI_SRC:%.c=$(OUT)/%.o)
SUPPORT_OBJ := $(patsubst %.c,$(OUT)/%.o,$(wildcard tests/support/*.c))
TEST_SRC := $(wildcard tests/unit/test_*.c tests/derivatives/test_*.c tests/kernels/test_*.c tests/property/test_*.c)
TESTS    := $(TEST_SRC:%.c=$(OUT)/%)
GOLDEN   := $(patsubst %.c,$(OUT)/%,$(wildcard tests/golden/test_*.c))

.PHONY: all
all: build/tides build/libtides.so ## Build the library and the command line tool (default)

# Flags that change rebuild what they changed.
$(OUT)/.flags: FORCE
	@mkdir -p $(@D)
	@echo '$(CC) $(CPPFLAGS) $(CFLAGS)' | cmp -s - $@ || echo '$(CC) $(CPPFLAGS) $(CFLAGS)' > $@
.PHONY: FORCE
FORCE:

$(OUT)/kernels_embedded.c: kernels/cl2c.sh $(KERNELS)
	@mkdir -p $(@D)
	sh kernels/cl2c.sh $(KERNELS) > $@.part && mv $@.part $@
$(OUT)/%.o: %.c $(OUT)/.flags
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c $< -o $@
$(OUT)/kernels_embedded.o: $(OUT)/kernels_embedded.c $(OUT)/.flags
	$(CC) $(CPPFLAGS) $(CFLAGS) -c $< -o $@

$(OUT)/libtides.a: $(LIB_OBJ)
	@rm -f $@
	$(AR) rcs $@ $(LIB_OBJ)
$(OUT)/libtides.so.$(VERSION): $(LIB_OBJ)
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libtides.so.$(MAJOR) -Wl,--no-undefined -o $@ $(LIB_OBJ) $(LDLIBS)
	ln -sf libtides.so.$(VERSION) $(OUT)/libtides.so.$(MAJOR)
	ln -sf libtides.so.$(VERSION) $(OUT)/libtides.so
$(OUT)/tides: $(CLI_OBJ) $(OUT)/libtides.so.$(VERSION)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $(CLI_OBJ) -L$(OUT) -ltides -Wl,-rpath,'$$ORIGIN:$$ORIGIN/../lib' $(LDLIBS)
build/tides: $(OUT)/tides
	ln -sf $(CONFIG)/tides $@
build/libtides.so: $(OUT)/libtides.so.$(VERSION)
	ln -sf $(CONFIG)/libtides.so $@

# Tests reach internals, so they link the objects, not the shared library.
$(OUT)/tests/%: $(OUT)/tests/%.o $(SUPPORT_OBJ) $(OUT)/libtides.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $< $(SUPPORT_OBJ) $(OUT)/libtides.a $(LDLIBS) -lcmocka

.PHONY: tests
tests: $(TESTS) $(GOLDEN) ## Build the test programs

-include $(LIB_OBJ:.o=.d) $(CLI_OBJ:.o=.d) $(TESTS:=.d) $(GOLDEN:=.d) $(SUPPORT_OBJ:.o=.d)
