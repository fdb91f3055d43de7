# SPDX-License-Identifier: Apache-2.0
# drape. `make help` lists what can be made. One Makefile, nothing recursive
# but flavours: each flavour is this file again with another BUILD.

BUILD  ?= build
ifeq ($(origin CC),default)
CC     := gcc
endif
ifeq ($(origin CXX),default)
CXX    := g++
endif
OPT    ?= -O2 -g
WARN   := -Wall -Wextra -Wpedantic -Werror
# The number model: no contraction, no reassociation, no traps, no errno.
MODEL  := -ffp-contract=off -fno-math-errno -fno-fast-math
OPENMP ?= -fopenmp
FLAGS   = $(OPT) $(WARN) $(MODEL) $(OPENMP) $(SAN) -I. -Ispec -MMD -MP -fPIC
CFLAGS_ = -std=c17 -D_POSIX_C_SOURCE=200809L $(FLAGS)
PREFIX ?= /usr/local

have   = $(shell printf '$(2)\n' | $(CXX) $(1) -x c++ -fsyntax-only - \
           2>/dev/null && echo yes)

REF    := $(sort $(wildcard ref/*.c))
TWICE  := $(sort $(filter-out tests/check.c tests/case.c tests/choices.c, \
            $(wildcard tests/*.c)))
ONCE   := tests/check.c tests/case.c tests/choices.c
APP    := $(sort $(wildcard app/*.c))

obj     = $(patsubst %.c,$(BUILD)/%$(2).o,$(1))
REF_O  := $(call obj,$(REF),.32) $(call obj,$(REF),.64)
TEST_O := $(call obj,$(TWICE),.32) $(call obj,$(TWICE),.64) \
          $(call obj,$(ONCE),)
APP_O  := $(call obj,$(APP),)
LIB    := $(BUILD)/libdrape.a
APP_LIBS := -lassimp -lcjson -lembree3 -lpng -lgmp -lm

.PHONY: all check stages bench golden help FORCE
.DELETE_ON_ERROR:

all: $(LIB) $(BUILD)/check

$(BUILD)/%.32.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_) -DREAL_BITS=32 -c $< -o $@
$(BUILD)/%.64.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_) -DREAL_BITS=64 -c $< -o $@
$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_) -c $< -o $@

$(LIB): $(REF_O)
	@rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/check: $(TEST_O) $(LIB)
	$(CC) $(CFLAGS_) $^ -o $@ -lm

check: $(BUILD)/check
	$(BUILD)/check --stages --tests --self-test \
	    --golden tests/golden/stages.txt

bench: $(BUILD)/check
	$(BUILD)/check --bench

golden: $(BUILD)/check ## records the hashes of all stages anew
	$(BUILD)/check --golden-write tests/golden/stages.txt

-include $(REF_O:.o=.d) $(TEST_O:.o=.d) $(APP_O:.o=.d)
