# Two commands do everything on a fresh machine that has cargo. Each installs what is missing if it may.
.PHONY: demo test check report

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
