# SPDX-License-Identifier: Apache-2.0
# drape: `make help` lists what can be made. Nothing is recursive but the
# flavours of ci/flavours.mk: this file again with another BUILD and compiler.

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
WARN   := -Wall -Wextra -Wpedantic -Werror
# The number model (spec/README.md §1): no contraction, no reassociation.
MODEL  := -ffp-contract=off -fno-math-errno -fno-fast-math
COMMON  = $(OPT) $(WARN) $(MODEL) $(OPENMP) $(SAN) -I. -Ispec -I$(BUILD) \
          -MMD -MP -fPIC
C17     = $(CC) -std=c17 -D_POSIX_C_SOURCE=200809L $(COMMON)
CXX17   = $(CXX) -std=c++17 -O1 -I. -Ispec $(EIGEN) -MMD -MP -fPIC

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
          -Xcompiler -Wall,-Wextra,-Werror,-fPIC,-ffp-contract=off -I. -Ispec \
          -I$(BUILD) -MMD -MP
CUDA_L  = -L$(dir $(realpath $(NVCC)))../lib64 -lcudart_static -lstdc++ \
          -lpthread -ldl -lrt -lm
# -O1: what is slow in emulated kernels is to change threads. C++14, as after
# it math.h alone takes as long to compile as a file of kernels. What C's
# functions return is incomplete in files that do not call them: clang warns.
EMU     = $(CXX) -x c++ -std=gnu++14 $(OPT:-O2=-O1) -Wall -Wextra -Werror \
          -Wno-return-type-c-linkage $(MODEL) -I. -Ispec -I$(BUILD) -MMD -MP -fPIC

# FCL's headers want Eigen's.
EIGEN   := -isystem /usr/include/eigen3

# What is here to build with: each answer is `yes` or nothing. Each make asks,
# so the headers are looked for, not compiled: FCL's take seconds.
HASH    := \#
has     = $(shell printf '$(HASH)if !__has_include(<%s>)\n$(HASH)error\n'$(\
            )'$(HASH)endif\n' $(1) | $(CXX) -std=c++17 -x c++ $(EIGEN) \
            -E - >/dev/null 2>&1 && echo yes)
HAS_APP    := $(call has,assimp/cimport.h cjson/cJSON.h embree3/rtcore.h \
    png.h gmp.h)
HAS_ORACLE := $(call has,CGAL/version.h Eigen/Dense fcl/fcl.h ccd/ccd.h gmp.h \
    mpfr.h)

API    := ref/base/arena.c ref/api/defaults.c ref/api/define.c ref/api/drape.c ref/api/frames.c \
          ref/api/query.c ref/base/threads.c ref/base/threads_clang.c
# The GPU part is built where nvcc and a device are, or by GPU=yes.
NVCC   := $(shell command -v nvcc)
GPU    ?= $(and $(NVCC),$(wildcard /dev/nvidia0 /dev/nvidiactl),yes)
REF    := $(sort $(filter-out $(API),$(wildcard ref/*/*.c)))
ONCE   := tests/base/check.c tests/base/case.c tests/base/certify.c tests/base/choices.c \
          tests/base/device.c tests/base/tally.c
TWICE  := $(sort $(filter-out $(ONCE) tests/whole/%,$(wildcard tests/*/*.c)))
# Kernels; but for memory.cu and words.cu, these are CUDA's own, which emulate*.cpp
# replace.
DEVICE := gpu/compare/blas.cu $(addprefix gpu/run/,device.cu loop.cu memory.cu \
          prim.cu stream.cu words.cu)
KERNEL := $(sort $(filter-out $(DEVICE),$(wildcard gpu/*/*.cu)))
APP    := $(sort $(wildcard app/*.c))
ORACLE := $(sort $(wildcard oracle/*.cpp oracle/*.c))
APP_LIBS    := -lassimp -lcjson -lembree3 -lpng -lgmp -lm
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
          $(call obj,$(KERNEL),.64) $(addprefix $(BUILD)/gpu/run/,emulate.o \
          emulate_prim.o emulate_stream.o emulate_threads.o memory.o words.o) \
          $(BUILD)/gpu/compare/emulate_blas.o)
CUDA_O := $(patsubst $(BUILD)/%,$(BUILD)/cuda/%,$(call obj,$(KERNEL),.32) \
          $(call obj,$(KERNEL),.64) $(call obj,$(DEVICE),))
# Without their libraries one file stands in for all oracles but brute force.
# CGAL's take a minute to compile, so the flavours share ROOT's too.
ORC_O  := $(addprefix $(ROOT)/,$(addsuffix .o,$(basename $(if \
          $(HAS_ORACLE),$(filter-out oracle/absent.c oracle/frames.cpp \
          oracle/table.cpp,$(ORACLE)),oracle/absent.c oracle/brute.c))))
ORC_L  := $(if $(HAS_ORACLE),$(ORACLE_LIBS))
LIB    := $(BUILD)/libdrape.a
# Time against error, stability, skipped work: spec/accuracy.md. A few files
# look inside; all else is the public API, so a device runs it too.
MACHINE ?= $(shell uname -m)
ACC     := $(BUILD)/accuracy $(BUILD)/accuracy-bare
ACC_O   := $(call obj,$(addprefix ci/bench/,accuracy backends bisect contact drift \
           never newton orders runs samples skip solids stability stages stress \
           work $(if $(HAS_APP),lion,no_app)),) \
           $(call obj,ci/bench/impact,.32) $(call obj,ci/bench/forced,.64) \
           $(foreach p,.32 .64,$(call obj,ci/bench/solves \
           $(addprefix tests/,base/reals cloth/sheet solve/solver solve/system),$(p))) \
           $(call obj,tests/base/choices) $(if $(HAS_APP),$(filter-out \
           $(BUILD)/app/main.o,$(APP_O))) $(ORC_O) $(LIB)
ACC_L   := $(if $(HAS_APP),$(APP_LIBS)) $(ORC_L) -lstdc++ -lm \
           $(if $(GPU),$(CUDA_L))

.PHONY: all demo check bench reference certify fuzz install help golden \
        format tidy check-parts soak fuzz-soak mutants outcomes prove oracles \
        fuzz-libs price launches say-gpu tables
.DELETE_ON_ERROR:

all: $(LIB) $(BUILD)/check $(if $(HAS_APP),$(BUILD)/drape) say-gpu ## library, tool

say-gpu:
	@$(if $(GPU),,echo 'drape: $(if $(NVCC),no device,no nvcc) here: CPU part only')

# Tests take longer to compile than to run. One that no table runs is told of.
$(BUILD)/tests/%.o: OPT := -O1
$(BUILD)/tests/%.o: WARN += -Wmissing-prototypes
$(BUILD)/%.32.o: %.c
	@mkdir -p $(@D)
	$(C17) -DREAL_BITS=32 -c $< -o $@
# The library's loops run on its own threads, which sleep while they wait, as
# OpenMP's need not: what the compiler calls takes the names of ref/base/threads.h.
OBJCOPY ?= objcopy
RENAMES  = $(addprefix --redefine-sym ,GOMP_parallel=threads_parallel \
          omp_get_thread_num=threads_number omp_get_num_threads=threads_count \
          $(addprefix __kmpc_,fork_call=threads_fork \
          global_thread_num=threads_global \
          serialized_parallel=threads_serialized \
          end_serialized_parallel=threads_end_serialized \
          for_static_init_4=threads_init_4 for_static_init_4u=threads_init_4u \
          for_static_init_8=threads_init_8 for_static_init_8u=threads_init_8u \
          for_static_fini=threads_fini reduce_nowait=threads_reduce \
          end_reduce_nowait=threads_end_reduce))
$(BUILD)/ref/%.32.o: ref/%.c
	@mkdir -p $(@D)
	$(C17) -DREAL_BITS=32 -c $< -o $@
	@$(OBJCOPY) $(RENAMES) $@
$(BUILD)/ref/%.64.o: ref/%.c
	@mkdir -p $(@D)
	$(C17) -DREAL_BITS=64 -c $< -o $@
	@$(OBJCOPY) $(RENAMES) $@
$(BUILD)/%.64.o: %.c
	@mkdir -p $(@D)
	$(C17) -DREAL_BITS=64 -c $< -o $@
$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(C17) -c $< -o $@
$(BUILD)/gpu/%.32.o: gpu/%.cu
	@mkdir -p $(@D)
	$(EMU) $(SAN) -DREAL_BITS=32 -c $< -o $@
$(BUILD)/gpu/%.64.o: gpu/%.cu
	@mkdir -p $(@D)
	$(EMU) $(SAN) -DREAL_BITS=64 -c $< -o $@
$(BUILD)/gpu/%.o: gpu/%.cpp
	@mkdir -p $(@D)
	$(EMU) -c $< -o $@
$(BUILD)/gpu/%.o: gpu/%.cu
	@mkdir -p $(@D)
	$(EMU) $(SAN) -c $< -o $@
$(BUILD)/cuda/gpu/%.32.o: gpu/%.cu
	@mkdir -p $(@D)
	$(CUDA) -DREAL_BITS=32 -c $< -o $@
$(BUILD)/cuda/gpu/%.64.o: gpu/%.cu
	@mkdir -p $(@D)
	$(CUDA) -DREAL_BITS=64 -c $< -o $@
$(BUILD)/cuda/gpu/%.o: gpu/%.cu
	@mkdir -p $(@D)
	$(CUDA) -c $< -o $@
# What drape_info says of ci/certificate.json, rewritten where it changes.
$(BUILD)/certificate.h: FORCE
	@mkdir -p $(@D)
	@new=$@.$$$$; echo "#define CERTIFICATE \"$$(python3 ci/certificate.py \
	  line ci/certificate.json 2>/dev/null || \
	  echo 'NOT CERTIFIED (python3 and git must be there to tell)')\"" >$$new; \
	  cmp -s $@ $$new && rm $$new || mv $$new $@
FORCE:
$(BUILD)/gpu/run/absent.o $(BUILD)/gpu/run/emulate.o $(BUILD)/cuda/gpu/run/device.o: \
    $(BUILD)/certificate.h
$(ROOT)/oracle/%.o: oracle/%.c
	@mkdir -p $(@D)
	$(CC) -std=c17 -O1 $(WARN) -I. -MMD -MP -fPIC -c $< -o $@
$(ROOT)/oracle/%.o: oracle/%.cpp
	@mkdir -p $(@D)
	$(CXX17) -c $< -o $@

$(LIB): $(REF_O) $(if $(GPU),$(CUDA_O),$(BUILD)/gpu/run/absent.o)
	@rm -f $@
	$(AR) rcs $@ $^
$(BUILD)/check: $(TEST_O) $(EMU_O) $(ORC_O) $(LIB)
	$(C17) $(TEST_O) $(EMU_O) $(ORC_O) $(LIB) -o $@ $(ORC_L) -lstdc++ -lm
# Without the oracles: so it runs on a device's machine that has none.
$(BUILD)/check-cuda: $(TEST_O) $(CUDA_O) $(ROOT)/oracle/absent.o \
    $(ROOT)/oracle/brute.o $(LIB)
	$(C17) $^ -o $@ $(CUDA_L)
$(BUILD)/whole: $(WHOLE_O) $(LIB)
	$(C17) $^ -o $@ -lpthread $(if $(GPU),$(CUDA_L),-lm)
$(BUILD)/drape: $(APP_O) $(LIB)
	$(C17) $(APP_O) $(LIB) -o $@ $(APP_LIBS) $(if $(GPU),$(CUDA_L))

# For fuzzing: everything but the main functions, both precisions.
TARGETS := bank calls create damage draw load queries small stage step table \
           whole
READERS := checkpoint csv files mutate part readers report strict
PARTS := $(filter-out $(addprefix $(BUILD)/tests/base/,check.o certify.o), \
         $(TEST_O)) $(REF_O) $(EMU_O) $(ORC_O) \
         $(call obj,$(addprefix fuzz/,$(TARGETS))) \
         $(if $(HAS_APP),$(filter-out $(BUILD)/app/main.o,$(APP_O)) \
         $(call obj,$(addprefix fuzz/,$(READERS))),$(BUILD)/fuzz/absent.o)
FUZZ_L := $(ORC_L) $(if $(HAS_APP),$(APP_LIBS)) -lstdc++ -lm
# Comparisons are not traced where there are millions of them: ci/fuzz.sh.
$(BUILD)/ref/%.o $(BUILD)/tests/%.o: MODEL += $(UNTRACED)
# The words of a scene's documentation, for those who change scenes.
$(BUILD)/words.h: app/scenes/README.md
	@mkdir -p $(@D)
	grep -o '`[^` ]*`' $< | tr -d '`"' | grep -x '[a-z0-9_-]*' | sort -u | \
	  sed 's/.*/"&",/' >$@
$(BUILD)/fuzz/mutate.o: $(BUILD)/words.h
$(BUILD)/parts.a: $(PARTS)
	@rm -f $@
	$(AR) rcs $@ $^
$(BUILD)/replay: $(BUILD)/fuzz/main.o $(BUILD)/parts.a
	$(C17) $^ -o $@ $(FUZZ_L)

check: ## everything that must hold
	sh ci/check.sh $(BUILD)
# What its parts share, so that they can run side by side.
check-parts: all $(ACC) $(BUILD)/whole.txt $(BUILD)/replay \
    $(if $(HAS_ORACLE),$(BUILD)/frames)

demo: $(BUILD)/drape ## drapes a cloth over the lion: pictures, film, report
	sh ci/demo.sh $(BUILD)

bench: $(BUILD)/check $(BUILD)/speed $(ACC) ## time, bytes, error, as csv, plots
	sh ci/bench/run.sh $(BUILD) $(MACHINE)
	$(if $(GPU),$(BUILD)/accuracy --backend gpu ci/bench/$(MACHINE) backends)
	$(if $(GPU),$(MAKE) tables)
# What ci/bench/scenes.sh asks for may be given: make tables SCENES=lion_20k
tables: $(BUILD)/drape ## on a device: the paper's figures, in ci/bench/MACHINE
	sh ci/bench/scenes.sh $(BUILD) $(BUILD)/bench; status=$$?; \
	  python3 ci/bench/tables.py $(BUILD)/bench/results; exit $$status
# The narrow phase beside FCL and GMP, on one thread.
$(BUILD)/speed: $(BUILD)/ci/bench/narrow.32.o $(BUILD)/tests/narrow/ply.32.o \
    $(ORC_O) $(LIB)
	$(C17) $^ -o $@ $(ORC_L) -lstdc++ -lm

$(BUILD)/accuracy: $(ACC_O)
	$(C17) $^ -o $@ $(ACC_L)
$(BUILD)/accuracy-bare: $(BUILD)/ci/bench/bare.o $(ACC_O)
	$(C17) -Wl,--allow-multiple-definition $^ -o $@ $(ACC_L)

# The same kernels by the number model's flags, with fma, and as fast as nvcc
# makes them.
EXACT      := --fmad=false -prec-div=true -prec-sqrt=true -ftz=false
LOOSE_exact = $(EXACT)
LOOSE_fma   = $(subst --fmad=false,--fmad=true,$(EXACT))
LOOSE_fast  = --use_fast_math
LOOSE_O    := $(foreach f,exact fma fast,$(BUILD)/cuda/price/$(f).32.o \
              $(BUILD)/cuda/price/$(f).64.o)
PRICE_O    := $(call obj,ci/bench/price,.32) $(call obj,ci/bench/price,.64) \
              $(call obj,ci/bench/main) $(LOOSE_O) $(BUILD)/cuda/gpu/run/device.o
$(LOOSE_O): $(BUILD)/cuda/price/%.o: ci/bench/kernels.cu
	@mkdir -p $(@D)
	$(subst $(EXACT),$(LOOSE_$(basename $*)),$(CUDA)) -DFLAGS=$(basename $*) \
	  -DREAL_BITS=$(subst .,,$(suffix $*)) -c $< -o $@
$(BUILD)/price: $(PRICE_O) $(LIB)
	$(C17) $^ -o $@ $(CUDA_L)
price: $(BUILD)/price ## what exactness costs on a device, as csv
	$(BUILD)/price

$(BUILD)/launches: ci/bench/launches.cu
	@mkdir -p $(@D)
	$(CUDA) $< -o $@ $(CUDA_L)
launches: $(BUILD)/launches ## what launches, graphs and looks cost there, as csv
	$(BUILD)/launches

# A program that shares the device with a world: app/examples/share.cu.
$(BUILD)/share.o: app/examples/share.cu
	@mkdir -p $(@D)
	$(CUDA) -c $< -o $@
$(BUILD)/share: $(BUILD)/share.o $(LIB)
	$(C17) $^ -o $@ $(CUDA_L)

$(BUILD)/table: $(ROOT)/oracle/table.o $(ORC_O)
	$(CXX17) $^ -o $@ $(ORC_L)
# CGAL's audit of a run's frames, beside `drape audit`.
$(BUILD)/frames: $(ROOT)/oracle/frames.o $(ROOT)/oracle/cgal_self.o
	$(CXX17) $^ -o $@ $(ORC_L)
DRAPE_DATA ?= ../shared
oracles: $(BUILD)/table ## the tables of oracle/README.md, from DRAPE_DATA
	$(BUILD)/table $(DRAPE_DATA)/ccd/queries/*.csv

fuzz-libs: # what links with parts.a, for ci/fuzz.sh
	@echo $(FUZZ_L)

golden: $(BUILD)/check ## records the hashes of all stages anew
	$(BUILD)/check --golden-write tests/golden/stages.txt

reference: $(BUILD)/drape ## scenes of certify by ref/: ci/reference.txt, an hour
	sh ci/certify.sh $(BUILD) none reference

certify: ## compares ref and gpu on the device: ci/certificate.json
	$(MAKE) GPU=yes $(BUILD)/check-cuda $(BUILD)/drape
	sh ci/certify.sh $(BUILD) ci/certificate.json

include ci/flavours.mk

prove: ## Gappa bounds every constant of the filters anew
	sh ci/prove.sh

N ?= 60
SEED ?= 1
mutants: ## plants N=60 faults in changed lines (ALL=1: in any) by SEED=: who sees?
	python3 ci/mutants.py -n $(N) --seed $(SEED) $(if $(ALL),--all) \
	  $(if $(BASE),--base $(BASE)) --work $(BUILD)/mutants

soak: check-parts ## the tests' long forms: whole frames, 2M triangles
	sh ci/flavour.sh $(BUILD) asan yes
	DRAPE_SOAK=1 $(BUILD)/check --tests

outcomes: $(BUILD)/drape ## whole scenes for 120 frames: table of bench/outcomes.md
	sh ci/outcomes.sh $(BUILD)

fuzz: ## T=target S=seconds: libFuzzer on one target
	sh ci/fuzz.sh $(BUILD) $(T) $(S)
fuzz-soak: ## S=seconds, or an hour: libFuzzer on every target, or those of T=
	sh ci/fuzz.sh $(BUILD) soak $(or $(S),3600) $(T)

VERSION = $(shell sed -n 's/.*DRAPE_VERSION "\(.*\)"/\1/p' spec/drape.h)
install: $(LIB) ## to $(DESTDIR)$(PREFIX): library, header, tool, man page
	install -D -m 644 $(LIB) $(DESTDIR)$(PREFIX)/lib/libdrape.a
	install -D -m 644 spec/drape.h $(DESTDIR)$(PREFIX)/include/drape.h
	install -d $(DESTDIR)$(PREFIX)/lib/pkgconfig
	@printf '%s\n' 'prefix=$${pcfiledir}/../..' 'Name: drape' \
	  'Description: certified high-resolution cloth simulation' \
	  'Version: $(VERSION)' 'Cflags: -I$${prefix}/include' \
	  'Libs: -L$${prefix}/lib -ldrape -pthread $(if $(GPU),$(CUDA_L),-lm)' \
	  >$(DESTDIR)$(PREFIX)/lib/pkgconfig/drape.pc
	test ! -x $(BUILD)/drape || install -D $(BUILD)/drape \
	  $(DESTDIR)$(PREFIX)/bin/drape
	install -D -m 644 app/drape.1 \
	  $(DESTDIR)$(PREFIX)/share/man/man1/drape.1

format: ## clang-format everything in place
	clang-format -i $(wildcard app/*.[ch] app/examples/* fuzz/*.[ch] \
	  gpu/*/* oracle/*.[ch]* ref/*/*.[ch] spec/*.h tests/*/*.[ch])

# The analyzer's search is cut at 20000 nodes (225000 usually) for the time
# it takes: paths that only a longer search finds are not looked at.
TIDY := -std=c17 -I. -Ispec -I$(BUILD) -D_POSIX_C_SOURCE=200809L \
        -Xclang -analyzer-config -Xclang max-nodes=20000
tidy: $(BUILD)/words.h ## clang-tidy over our C
	ls app/*.c app/examples/*.c fuzz/*.c ref/*/*.c tests/*/*.c | \
	  xargs -P2 -n8 sh -c 'clang-tidy --quiet "$$@" -- $(TIDY) 2>/dev/null' sh

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile ci/flavours.mk | \
	  expand -t 11
	@echo 'tables also takes SCENES= FRAMES= MODES= LIMIT=: ci/bench/scenes.sh'
	@echo "OPT=      '-O2 -g', say: for a debugger"
	@echo 'GPU=yes   with any of them: builds the device part without a device'
	@echo 'ARCHES=   "80 90", say: for which devices; all: every one nvcc knows'

-include $(patsubst %.o,%.d,$(REF_O) $(TEST_O) $(WHOLE_O) $(APP_O) $(ORC_O) \
  $(EMU_O) $(CUDA_O) $(PRICE_O) $(filter %.o,$(ACC_O)))
-include $(patsubst %.o,%.d,$(PARTS) $(BUILD)/fuzz/main.o \
  $(BUILD)/ci/bench/narrow.32.o $(ROOT)/oracle/frames.o $(ROOT)/oracle/table.o)
