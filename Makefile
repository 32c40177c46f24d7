# The front door: `make` lists what can be asked for. Everything runs in .venv, which the first call sets up.

PYTHON = python3.11
JOBS = 2
PY = .venv/bin/python

.PHONY: help demo run frame-given test verilog firmware lint bench exhaustive docs quartus ip synth report ulx3s clean
.DELETE_ON_ERROR:

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z0-9]+:.*## /{printf "make %-11s %s\n", $$1, $$2}' Makefile
	@echo 'Any of them takes more arguments as ARGS="...", and the first sets up .venv (PYTHON=$(PYTHON)).'

demo: .venv/installed ## Render a scene, let the hardware find its markers, and show what it says
	$(PY) -m sim demo $(ARGS)

run: frame-given .venv/installed ## Let the hardware look at your picture: FRAME=picture [JSON=file] [OUT=folder]
	$(PY) -m sim run "$(FRAME)" $(if $(JSON),--json "$(JSON)") $(if $(OUT),--out "$(OUT)") $(ARGS)

test: .venv/installed ## Run all tests but the exhaustive ones, JOBS=2 at a time
	@echo "Icarus Verilog: $$(command -v iverilog || echo 'not found, so its tests are skipped (Debian: apt-get install iverilog)')"
	$(PY) -m pytest -n $(JOBS) $(ARGS)

verilog: .venv/installed ## Write the hardware as Verilog: build/out/rasterpose.v, rasterpose_system.v, blocks in build/out/verilog
	$(PY) -m firmware.toolchain sensor
	$(PY) -m hdl.emit --program build/out/firmware/sensor.bin $(ARGS)

firmware: .venv/installed ## Build the firmware of the soft core and say how large it is: build/out/firmware
	$(PY) -m firmware.toolchain $(ARGS)

lint: .venv/installed ## Check the sources with ruff, and their Verilog with Verilator and Icarus
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	find firmware tests -name '*.[ch]' | xargs .venv/bin/clang-format --dry-run -Werror --style=file:firmware/.clang-format
	$(PY) -m hdl.lint $(ARGS)

bench: .venv/installed ## Measure accuracy, false alarms, speed and latency
	$(PY) -m sim bench $(ARGS)

report: .venv/installed ## Compare with rivals and redo the paper's experiments: build/out/report; QUICK=1 in two minutes
	$(PY) -m sim report $(if $(QUICK),--quick) $(ARGS)

exhaustive: .venv/installed ## Run the tests that try every case, which takes long
	$(PY) -m pytest -n $(JOBS) -m long $(ARGS)
	$(PY) -m pytest -n $(JOBS) tests/exhaustive $(ARGS)

docs: .venv/installed ## Write the register map for people and for C: build/out/registers
	$(PY) -m hdl.regs.docs $(ARGS)

quartus: .venv/installed ## Write the Quartus project of the DE2-115 with a D5M camera: build/out/quartus
	$(PY) -m build.quartus $(ARGS)

ulx3s: .venv/installed ## Make a bitstream for the ULX3S with open tools, which takes minutes: build/out/ulx3s
	$(PY) -m build.ulx3s $(ARGS)

ip: .venv/installed ## Package the hardware for Platform Designer, FuseSoC and IP-XACT: build/out/ip
	$(PY) -m firmware.toolchain sensor
	$(PY) -m build.ip --program build/out/firmware/sensor.bin $(ARGS)

synth: .venv/installed ## Estimate area and clock speed by open tools: build/out/synth.json
	$(PY) -m build.synth $(ARGS)

clean: ## Remove all products (.venv stays)
	rm -rf build/out

frame-given:
	$(if $(FRAME),@:,$(error FRAME is missing; say which picture: make run FRAME=picture.png))

# The stamp is made last, so a set-up that was interrupted is taken up again.
.venv/installed: pyproject.toml build/constraints.txt
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) not found: install Python 3.11, or say where it is with PYTHON=..."; exit 1; }
	@echo "Setting up .venv from PyPI; this takes a minute or two, once"
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11) and "Python 3.11 is needed: make PYTHON=...")'
	test -x .venv/bin/pip || $(PYTHON) -m venv .venv
	@$(PY) -c 'import tomllib; p = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
	print(*p["dependencies"], *p["optional-dependencies"]["test"], sep="\n")' > .venv/requirements.txt
	$(PY) -m pip install --disable-pip-version-check -r .venv/requirements.txt -c build/constraints.txt
	@touch $@
