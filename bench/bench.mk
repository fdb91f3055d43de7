# SPDX-License-Identifier: Apache-2.0
# What bench and validate measure, and the tables of oracle/README.md.

.PHONY: bench validate tables compare price launches outcomes oracles many
MACHINE ?= $(shell uname -m)
# Programs that are modules of this tree, by the Python package.
BY_PACKAGE := $(BUILD)/accuracy $(BUILD)/validate
define by_package
@rm -f $@
@printf '#!/bin/sh\nPYTHONPATH="%s" exec "%s" -m $(1) "$$@"\n' \
  "$(CURDIR):$(abspath $(PACKAGE))" "$(abspath $(PY))/venv/bin/python" >$@
@chmod +x $@
endef

# Time against error, stability, skipped work, by the package, so that a device runs them
# too; and a library for what looks inside. spec/accuracy.md
BARE_O  := $(call obj,bench/bare) $(call obj,bench/inside,.64) \
           $(call obj,$(addprefix tests/,base/reals cloth/sheet),.64) \
           $(call obj,tests/base/choices)
BARE_U  := $(addprefix -Wl$(comma)-u$(comma)drape_,create step read destroy)
$(BUILD)/bare.so: $(BARE_O) $(INSIDE)
	$(C17) -shared -Wl,--allow-multiple-definition $(BARE_U) $^ -o $@ -lm \
	  $(if $(GPU),$(CUDA_L))
$(BUILD)/accuracy: $(PACKAGE)/made $(BUILD)/bare.so
	$(call by_package,bench.accuracy --inside "$(abspath $(BUILD))/bare.so")

# Single stages, which are inside the library. spec/accuracy.md §8
SINGLE  := $(call obj,$(addprefix bench/,bench bisect stages)) $(call obj,bench/impact,.32) \
           $(foreach p,.32 .64,$(call obj,bench/solves \
           $(addprefix tests/,base/reals cloth/sheet solve/solver solve/system),$(p))) \
           $(call obj,tests/base/choices) $(ORC_O)
$(BUILD)/single: $(SINGLE) $(INSIDE)
	$(C17) $^ -o $@ $(ORC_L) -lstdc++ -lm $(if $(GPU),$(CUDA_L))

# Many small worlds on one machine. It looks inside to choose how a device runs.
$(BUILD)/bench/many.32.o: DEFINES := $(if $(GPU),-DMANY_GPU)
$(BUILD)/many: $(BUILD)/bench/many.32.o $(INSIDE)
	$(C17) $^ -o $@ -lpthread $(if $(GPU),$(CUDA_L),-lm)
many: $(BUILD)/many ## steps of many small worlds a second, on a device, as csv
	$(BUILD)/many

# The narrow phase beside FCL and GMP, on one thread.
$(BUILD)/speed: $(BUILD)/bench/narrow.32.o $(BUILD)/tests/narrow/ply.32.o \
    $(ORC_O) $(INSIDE)
	$(C17) $^ -o $@ $(ORC_L) -lstdc++ -lm

# Physics as a suite, by the Python package: spec/validation.md.
$(BUILD)/validate: $(PACKAGE)/made
	$(call by_package,validate)
validate: $(BUILD)/validate ## what cloth does against theory: validate/MACHINE
	sh validate/run.sh $(BUILD) $(MACHINE)

bench: $(addprefix $(BUILD)/,check speed accuracy single drape) ## time, bytes, error, as csv, plots
	sh bench/run.sh $(BUILD) $(MACHINE)
	$(if $(GPU),$(BUILD)/accuracy --backend gpu bench/$(MACHINE) backends)
	$(if $(GPU),$(MAKE) tables)
# What bench/scenes.sh asks for may be given: make tables SCENES=lion_20k
tables: $(BUILD)/drape ## on a device: the paper's figures, in bench/MACHINE; steps
	sh bench/scenes.sh $(BUILD) $(BUILD)/bench; status=$$?; \
	  python3 bench/tables.py $(BUILD)/bench/results; \
	  python3 bench/steps.py add $$(git rev-parse --short HEAD) "$$(nvidia-smi \
	    --query-gpu=name --format=csv,noheader | head -n 1)" \
	    $(BUILD)/bench/results/*.ours.json; exit $$status
compare: ## A=tree B=tree: what steps take, side by side: bench/steps.csv
	@python3 bench/steps.py $(A) $(B) $(SCENES)
outcomes: $(BUILD)/drape ## whole scenes for 120 frames: table of bench/outcomes.md
	sh bench/outcomes.sh $(BUILD)

# The same kernels by the number model's flags, with fma, and as fast as nvcc
# makes them.
EXACT      := --fmad=false -prec-div=true -prec-sqrt=true -ftz=false
LOOSE_exact = $(EXACT)
LOOSE_fma   = $(subst --fmad=false,--fmad=true,$(EXACT))
LOOSE_fast  = --use_fast_math
LOOSE_O    := $(foreach f,exact fma fast,$(BUILD)/cuda/price/$(f).32.o \
              $(BUILD)/cuda/price/$(f).64.o)
PRICE_O    := $(call obj,bench/price,.32) $(call obj,bench/price,.64) \
              $(call obj,bench/main) $(LOOSE_O) $(BUILD)/cuda/gpu/run/device.o
$(LOOSE_O): $(BUILD)/cuda/price/%.o: bench/kernels.cu | $(NAMES)
	@mkdir -p $(@D)
	$(call by,NVCC)$(subst $(EXACT),$(LOOSE_$(basename $*)),$(CUDA)) -DFLAGS=$(basename $*) \
	  -DREAL_BITS=$(subst .,,$(suffix $*)) -c $< -o $@
$(BUILD)/price: $(PRICE_O) $(INSIDE)
	$(C17) $^ -o $@ $(CUDA_L)
price: $(BUILD)/price ## what exactness costs on a device, as csv
	$(BUILD)/price

$(BUILD)/launches: bench/launches.cu
	@mkdir -p $(@D)
	$(call by,NVCC)$(CUDA) $< -o $@ $(CUDA_L)
launches: $(BUILD)/launches ## what launches, graphs and looks cost there, as csv
	$(BUILD)/launches

DRAPE_DATA ?= $(BUILD)/data
$(BUILD)/table: $(ROOT)/oracle/table.o $(ORC_O)
	$(CXX17) $^ -o $@ $(ORC_L)
# CGAL's audit of a run's frames, beside `drape audit`.
$(BUILD)/frames: $(ROOT)/oracle/frames.o $(ROOT)/oracle/cgal_self.o
	$(CXX17) $^ -o $@ $(ORC_L)
oracles: $(BUILD)/table ## the tables of oracle/README.md, from DRAPE_DATA
	$(BUILD)/table $(DRAPE_DATA)/ccd/queries/*.csv
