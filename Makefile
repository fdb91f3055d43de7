# SPDX-License-Identifier: Apache-2.0
# drape: `make help` lists what can be made. This file has the compilers, the
# sources, the rules and the library; included are ci/install.mk (the shared
# library, what is installed, packages), ci/flavours.mk (other compilers and
# flags: the only recursion), ci/fuzz.mk, ci/upkeep.mk, ci/python.mk,
# ci/equal/equal.mk (PTX of the kernels), ci/eva/eva.mk (contracts asserted) and
# bench/bench.mk.

BUILD  ?= build
PREFIX ?= /usr/local
ifeq ($(origin CC),default)
CC     := gcc
endif
ifeq ($(origin CXX),default)
CXX    := g++
endif
OPT    ?= -O2
OPENMP ?= -fopenmp
# Warnings are errors in CI only: another compiler may know other warnings.
WERROR ?= $(if $(CI),-Werror)
WARN   := -Wall -Wextra -Wpedantic $(WERROR)
# The number model (spec/README.md §1): no contraction, no reassociation.
MODEL  := -ffp-contract=off -fno-math-errno -fno-fast-math
COMMON  = $(OPT) $(LEVEL) $(CPPFLAGS) $(CFLAGS) $(WARN) $(MODEL) $(OPENMP) $(SAN) \
          $(DEFINES) -I. -Ispec -I$(BUILD) -MMD -MP -fPIC
# What a flavour compiles the tests with instead of -O1 (ci/flavours.mk).
TEST_LEVEL :=
LEVEL      :=
# A command is shown as a short line, `CC app/tool/run.c`; V=1 shows it whole, -s not.
MUTE   := $(findstring s,$(firstword -$(MAKEFLAGS)))
show    = $(if $(V),,@$(if $(MUTE),,echo '$(1)';) )
bits    = $(patsubst .%,$(comma) % bits,$(filter .32 .64,$(suffix $(basename $@))))
by      = $(call show,$(if $(filter %.o,$@),$(1) $<$(bits),LINK $@))
C17     = $(call by,CC)$(CC) -std=c17 -D_POSIX_C_SOURCE=200809L $(COMMON)
CXX17   = $(call by,CXX)$(CXX) -std=c++17 -O1 -I. -Ispec $(EIGEN) -MMD -MP -fPIC

# The same for kernels, by nvcc and, emulated, by the host's compiler.
# For the devices that are here, else for an H100; ARCHES=all: for every one
# that nvcc knows. PTX of the last is for those that come after it.
NATIVE  = $(shell nvidia-smi --query-gpu=compute_cap --format=csv,noheader \
          2>/dev/null | tr -d . | sort -nu)
ARCHES ?= $(or $(if $(GPU),$(NATIVE)),90)
KNOWN   = $(shell nvcc --list-gpu-code | sed -n 's/^sm_//p' | sort -nu)
# Asked once, when first used.
REALS   = $(eval REALS := $(if $(filter all,$(ARCHES)),$(KNOWN),$(ARCHES)))$(\
          )$(REALS)
CUDA    = nvcc -std=c++20 -O2 -lineinfo --fmad=false -prec-div=true \
          -prec-sqrt=true -ftz=false $(foreach a,$(REALS),-gencode \
          arch=compute_$(a),code=sm_$(a)) -gencode \
          arch=compute_$(lastword $(REALS)),code=compute_$(lastword $(REALS)) \
          -Xcompiler -Wall,-Wextra,-Werror,-fPIC,-ffp-contract=off \
          -Xcompiler -fno-gnu-unique -I. -Ispec -I$(BUILD) -MMD -MP
comma  := ,
NVCC_C  = $(call by,NVCC)$(if $(WERROR),$(CUDA),$(subst -Werror$(comma),,$(CUDA)))
CUDA_L  = -L$(dir $(realpath $(NVCC)))../lib64 -lcudart_static -lstdc++ \
          -lpthread -ldl -lrt -lm
# -O1: what is slow in emulated kernels is to change threads, which one file does
# (below). C++14, as after it math.h alone takes as long to compile as a file of
# kernels. What C's functions return is incomplete in files that do not call them:
# clang warns.
EMU_LEVEL = $(OPT:-O2=-O1)
EMU_OPT = $(EMU_LEVEL)
EMU     = $(call by,CXX)$(CXX) -x c++ -std=gnu++17 $(EMU_OPT) -Wall -Wextra $(WERROR) \
          -Wno-return-type-c-linkage $(MODEL) -I. -Ispec -I$(BUILD) -MMD -MP -fPIC

# FCL's headers want Eigen's.
EIGEN   := -isystem /usr/include/eigen3

# What is here to build with: each answer is `yes` or nothing. Each make asks,
# so the headers are looked for, not compiled: FCL's take seconds.
HASH    := \#
has     = $(shell printf '$(HASH)if !__has_include(<%s>)\n$(HASH)error\n'$(\
            )'$(HASH)endif\n' $(1) | $(CXX) -std=c++17 -x c++ $(EIGEN) \
            -E - >/dev/null 2>&1 && echo yes)
EMBREE     := $(or $(and $(call has,embree4/rtcore.h),4),3)
APP_H      := assimp/cimport.h jansson.h embree$(EMBREE)/rtcore.h png.h gmp.h
HAS_APP    := $(call has,$(APP_H))
ORACLE_H   := CGAL/version.h Eigen/Dense fcl/fcl.h ccd/ccd.h gmp.h mpfr.h
HAS_ORACLE := $(call has,$(ORACLE_H))

# Compiled once, whatever the precision: API and ONCE.
API    := $(addprefix ref/api/,bodies.c control.c defaults.c define.c \
          drape.c frames.c many.c query.c record.c record_body.c \
          replay.c) \
          $(addprefix ref/base/,arena.c threads.c threads_clang.c)
# The GPU part is built where nvcc and a device are, or by GPU=yes.
NVCC   := $(shell command -v nvcc)
GPU    ?= $(and $(NVCC),$(wildcard /dev/nvidia0 /dev/nvidiactl),yes)
REF    := $(sort $(filter-out $(API),$(wildcard ref/*/*.c)))
ONCE   := $(addprefix tests/base/,check.c case.c certify.c choices.c device.c \
          tally.c)
TWICE  := $(sort $(filter-out $(ONCE) tests/whole/%,$(wildcard tests/*/*.c)))
# Kernels; but for those that EMU_O names too, these are CUDA's own, which
# emulate*.cpp replace.
DEVICE := gpu/compare/blas.cu $(addprefix gpu/run/,batch.cu copies.cu device.cu gather.cu \
          kernel.cu loop.cu memory.cu merge.cu branch.cu prim.cu stream.cu words.cu)
KERNEL := $(sort $(filter-out $(DEVICE),$(wildcard gpu/*/*.cu)))
# The tool in rooms, each of which includes itself and those before it.
ROOMS  := base read scene write render tool
APP    := $(sort $(wildcard $(ROOMS:%=app/%/*.c)))
ORACLE := $(sort $(wildcard oracle/*.cpp oracle/*.c))
APP_LIBS    := -lassimp -ljansson -lembree$(EMBREE) -lpng -lgmp -lm
ORACLE_LIBS := -lfcl -lccd -lmpfr -lgmpxx -lgmp -lstdc++ -lm

obj     = $(addprefix $(BUILD)/,$(addsuffix $(2).o,$(basename $(1))))
REF_O  := $(call obj,$(REF),.32) $(call obj,$(REF),.64) \
          $(call obj,$(API),.64)
# Small whole scenes through the public API: every flavour runs them.
WHOLE_O := $(call obj,$(wildcard tests/whole/*.c),)
TEST_IN ?= $(BUILD)
TEST_O := $(patsubst $(BUILD)/%,$(TEST_IN)/%,$(call obj,$(TWICE),.32) \
          $(call obj,$(TWICE),.64) $(call obj,$(ONCE),))
APP_O  := $(call obj,$(APP),)
# gpu/ twice: as CUDA, and emulated on the host for build/check.
# ROOT is the build that flavours take from what they do not compile.
ROOT   ?= $(BUILD)
EMU_IN ?= $(BUILD)
EMU_O  := $(patsubst $(BUILD)/%,$(EMU_IN)/%,$(call obj,$(KERNEL),.32) \
          $(call obj,$(KERNEL),.64) $(addprefix $(BUILD)/gpu/run/,batch.o copies.o \
          emulate.o emulate_prim.o emulate_stream.o emulate_threads.o gather.o \
          memory.o merge.o words.o) \
          $(BUILD)/gpu/compare/emulate_blas.o)
CUDA_O := $(patsubst $(BUILD)/%,$(BUILD)/cuda/%,$(call obj,$(KERNEL),.32) \
          $(call obj,$(KERNEL),.64) $(call obj,$(DEVICE),))
# What tests of panels cut them with.
CUT_O  := $(call obj,$(wildcard app/base/cut*.c) \
          $(addprefix app/base/,buckets.c curve.c outline.c),)
# Without their libraries one file stands in for all oracles but brute force.
# CGAL's take a minute to compile, so the flavours share ROOT's too.
ORC_O  := $(addprefix $(ROOT)/,$(addsuffix .o,$(basename $(if \
          $(HAS_ORACLE),$(filter-out oracle/absent.c oracle/frames.cpp \
          oracle/table.cpp,$(ORACLE)),oracle/absent.c oracle/brute.c))))
ORC_L  := $(if $(HAS_ORACLE),$(ORACLE_LIBS))
# The library, and its objects in an archive for programs that look inside.
LIB    := $(BUILD)/libdrape.a
INSIDE := $(BUILD)/inside.a
.PHONY: all check check-parts demo help
.DELETE_ON_ERROR:

all: say ## library, tool, tests

# Macros that keep the two precisions' names apart: ref/base/names.h. They are
# rewritten where they change.
NAMES := $(addprefix $(BUILD)/names/,ref.h gpu.h tests.h)
$(BUILD)/names/ref.h: $(REF)
$(BUILD)/names/gpu.h: $(KERNEL) $(wildcard gpu/*/*.cuh)
$(BUILD)/names/tests.h: $(TWICE)
$(NAMES): ci/names.sh FORCE
	@mkdir -p $(@D)
	@new=$@.$$$$; sh ci/names.sh $(filter %.c %.cu %.cuh,$^) >$$new && \
	  { cmp -s $@ $$new && rm $$new || mv $$new $@; }

# Tests take longer to compile than to run. One that no table runs is told of.
$(BUILD)/tests/%.o: OPT := -O1
$(BUILD)/tests/%.o: LEVEL = $(TEST_LEVEL)
$(BUILD)/tests/%.o: WARN += -Wmissing-prototypes
# The library's loops run on its own threads, which sleep while they wait, as
# OpenMP's need not: what the compilers call is renamed by ref/base/threads.syms.
OBJCOPY ?= objcopy
SYMS    := ref/base/threads.syms
# C, kernels emulated on the host, and kernels: in each precision, and once.
define twice
$(BUILD)/%.$(1).o: %.c | $(NAMES)
	@mkdir -p $$(@D)
	$$(C17) -DREAL_BITS=$(1) -c $$< -o $$@
$(BUILD)/ref/%.$(1).o: ref/%.c $(SYMS) | $(NAMES)
	@mkdir -p $$(@D)
	$$(C17) -DREAL_BITS=$(1) -c $$< -o $$@
	@$$(OBJCOPY) --redefine-syms=$(SYMS) $$@
$(BUILD)/gpu/%.$(1).o: gpu/%.cu | $(NAMES)
	@mkdir -p $$(@D)
	$$(EMU) $$(SAN) -DREAL_BITS=$(1) -c $$< -o $$@
$(BUILD)/cuda/gpu/%.$(1).o: gpu/%.cu | $(NAMES)
	@mkdir -p $$(@D)
	$$(NVCC_C) -DREAL_BITS=$(1) -c $$< -o $$@
endef
$(foreach bits,32 64,$(eval $(call twice,$(bits))))
$(BUILD)/%.o: %.c | $(NAMES)
	@mkdir -p $(@D)
	$(C17) -c $< -o $@
# Half of an emulated step is in this file, which has no arithmetic of kernels. (By
# clang -O2 it ends in a fault: fibers switch out of calls that it makes jumps of.)
ifeq ($(findstring clang,$(CXX)),)
$(BUILD)/gpu/run/emulate_threads.o: EMU_OPT := -O2
endif
$(BUILD)/gpu/%.o: gpu/%.cpp | $(NAMES)
	@mkdir -p $(@D)
	$(EMU) -c $< -o $@
$(BUILD)/gpu/%.o: gpu/%.cu | $(NAMES)
	@mkdir -p $(@D)
	$(EMU) $(SAN) -c $< -o $@
$(BUILD)/cuda/gpu/%.o: gpu/%.cu | $(NAMES)
	@mkdir -p $(@D)
	$(NVCC_C) -c $< -o $@

# What drape_info says of ci/certificate.json, rewritten where it changes.
$(BUILD)/certificate.h: FORCE
	@mkdir -p $(@D)
	@new=$@.$$$$; echo "#define CERTIFICATE \"$$(python3 ci/certificate.py \
	  line ci/certificate.json 2>/dev/null || \
	  echo 'NOT CERTIFIED (python3 and git must be there to tell)')\"" >$$new; \
	  cmp -s $@ $$new && rm $$new || mv $$new $@
# What steps cost on machines where they were measured, for `drape plan`: the rows
# of bench/MACHINE/speed.csv as literals.
SPEEDS := $(sort $(wildcard bench/*/speed.csv))
$(BUILD)/speed.inc: $(SPEEDS) Makefile
	@mkdir -p $(@D)
	@for f in $(SPEEDS); do sed '1d;s/.*/"&\\n"/' $$f; done >$@
$(BUILD)/app/tool/speed.o: $(BUILD)/speed.inc
FORCE:
$(BUILD)/gpu/api/absent.o $(BUILD)/gpu/run/emulate.o $(BUILD)/cuda/gpu/run/device.o: \
    $(BUILD)/certificate.h
$(ROOT)/oracle/%.o: oracle/%.c
	@mkdir -p $(@D)
	$(call by,CC)$(CC) -std=c17 -O1 $(WARN) -I. -MMD -MP -fPIC -c $< -o $@
$(ROOT)/oracle/%.o: oracle/%.cpp
	@mkdir -p $(@D)
	$(CXX17) -c $< -o $@

$(INSIDE): $(REF_O) $(if $(GPU),$(CUDA_O),$(BUILD)/gpu/api/absent.o)
	@rm -f $@
	$(call show,AR $@)$(AR) rcs $@ $^
# A program that embeds drape may have functions of the same names, so the
# library is one object in which only the names of drape.h are global. Groups
# (instances of templates) are resolved here, too: the linker would drop a group
# for another of its name elsewhere and leave local references to nothing.
$(BUILD)/libdrape.o: $(INSIDE)
	$(call show,LD $@)$(LD) -r --force-group-allocation --whole-archive $< -o $@
	@$(OBJCOPY) --wildcard --keep-global-symbol='drape_*' $@
$(LIB): $(BUILD)/libdrape.o
	@rm -f $@
	$(call show,AR $@)$(AR) rcs $@ $<
$(BUILD)/check: $(TEST_O) $(CUT_O) $(EMU_O) $(ORC_O) $(INSIDE)
	$(C17) $(TEST_O) $(CUT_O) $(EMU_O) $(ORC_O) $(INSIDE) -o $@ $(ORC_L) -lstdc++ -lm
# Without the oracles: so it runs on a device's machine that has none.
$(BUILD)/check-cuda: $(TEST_O) $(CUT_O) $(CUDA_O) $(ROOT)/oracle/absent.o \
    $(ROOT)/oracle/brute.o $(INSIDE)
	$(C17) $^ -o $@ $(CUDA_L)
$(BUILD)/whole: $(WHOLE_O) $(LIB)
	$(C17) $^ -o $@ -lpthread $(if $(GPU),$(CUDA_L),-lm)
$(BUILD)/drape: $(APP_O) $(LIB)
	$(C17) $(LDFLAGS) $(APP_O) $(LIB) -o $@ $(APP_LIBS) $(if $(GPU),$(CUDA_L))

$(BUILD)/app/%.o: DEFINES := -DEMBREE=$(EMBREE)

# A program that shares the device with a world: app/examples/5_share.cu.
$(BUILD)/5_share.o: app/examples/5_share.cu
	@mkdir -p $(@D)
	$(NVCC_C) -c $< -o $@
$(BUILD)/5_share: $(BUILD)/5_share.o $(LIB)
	$(C17) $^ -o $@ $(CUDA_L)

include ci/install.mk ci/flavours.mk ci/fuzz.mk ci/upkeep.mk ci/python.mk \
        ci/equal/equal.mk ci/eva/eva.mk bench/bench.mk

check: ## everything that must hold
	@python3 ci/check.py $(BUILD)
# What its parts share, so that they can run side by side.
check-parts: all $(BUILD)/single $(BUILD)/whole.txt $(BUILD)/replay corpus \
    $(if $(HAS_ORACLE),$(BUILD)/frames)
	@$(MAKE) --no-print-directory $(BY_PACKAGE) || rm -f $(BY_PACKAGE)

demo: $(BUILD)/drape ## drapes a cloth over the lion: pictures, film, report
	@sh ci/demo.sh $(BUILD)

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile ci/*.mk bench/bench.mk | expand -t 11
	@echo 'tables also takes SCENES= FRAMES= MODES= LIMIT=: bench/scenes.sh'
	@echo "OPT=      '-O2 -g', say: for a debugger"
	@echo 'V=1       shows whole commands'
	@echo 'GPU=yes   with any of them: builds the device part without a device'
	@echo 'CI=true   compiler warnings are errors'
	@echo 'ARCHES=   "80 90", say: for which devices; all: every one nvcc knows'

-include $(patsubst %.o,%.d,$(REF_O) $(TEST_O) $(WHOLE_O) $(APP_O) $(ORC_O) \
  $(EMU_O) $(CUDA_O) $(PRICE_O) $(filter %.o,$(SINGLE)) $(BARE_O))
-include $(patsubst %.o,%.d,$(PARTS) $(BUILD)/fuzz/main.o \
  $(BUILD)/bench/narrow.32.o $(ROOT)/oracle/frames.o $(ROOT)/oracle/table.o)
