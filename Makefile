# Two commands do everything on a fresh machine that has cargo. Each installs what is missing if it may.
.PHONY: demo test check report install

# Pictures of the three built-in grooms in out/, with adapter, time and memory.
demo:
	@scripts/demo.sh

# All tests, on the software driver, under the Vulkan validation layer.
test:
	@scripts/test.sh

# Formatting, lints, documentation, tests.
check:
	@cargo xtask check

# Error, time and memory of every technique: docs/report/.
report:
	@cargo xtask report

# The shared library, its headers, and pkg-config and CMake files. PROFILE=dev installs a debug build; FROM=folder installs the
# library that lies there, and builds nothing.
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
PROFILE ?= release
export PREFIX LIBDIR INCLUDEDIR DESTDIR
ifdef FROM
install: export FROM := $(FROM)
else
install: export FROM := $(or $(CARGO_TARGET_DIR),target)/$(if $(filter dev,$(PROFILE)),debug,$(PROFILE))
install: built
.PHONY: built
built:
	@cargo build --lib --profile $(PROFILE)
endif
install:
	@scripts/install.sh
