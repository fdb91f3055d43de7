# SPDX-License-Identifier: Apache-2.0
# The debug flavour of the contracts in ref/ (ci/eva/contracts.py): build/check and a
# program of calls outside of them, linked so that calls from other files pass through
# functions that assert the contract. The files that have contracts are compiled anew,
# so that their own calls do, too; no other object of the library is.

CONTRACT_H := $(addprefix ref/narrow/,closest.h filter.h split.h predicates.h tritri.h)
ASSERTS    := $(BUILD)/contracts/asserts.32.o $(BUILD)/contracts/asserts.64.o
WITHIN     := $(foreach bits,32 64,$(CONTRACT_H:%.h=$(BUILD)/contracts/%.$(bits).o))
ASSERTED    = $(shell python3 ci/eva/contracts.py flags)

$(BUILD)/contracts/asserts.%.c: ci/eva/contracts.py $(CONTRACT_H)
	@mkdir -p $(@D)
	$(call show,ASSERTS $@)python3 ci/eva/contracts.py asserts $* >$@
$(ASSERTS): $(BUILD)/contracts/asserts.%.o: $(BUILD)/contracts/asserts.%.c | $(NAMES)
	$(C17) -DREAL_BITS=$* -c $< -o $@
define within_of
$(BUILD)/contracts/%.$(1).c: %.c %.h ci/eva/contracts.py
	@mkdir -p $$(@D)
	$$(call show,WITHIN $$@)python3 ci/eva/contracts.py within $$< $(1) >$$@
$(BUILD)/contracts/ref/%.$(1).o: $(BUILD)/contracts/ref/%.$(1).c | $(NAMES)
	$$(C17) -DREAL_BITS=$(1) -c $$< -o $$@
endef
$(foreach bits,32 64,$(eval $(call within_of,$(bits))))
$(BUILD)/contracts/outside.o: ci/eva/outside.c $(CONTRACT_H) | $(NAMES)
	@mkdir -p $(@D)
	$(C17) -DREAL_BITS=64 -c $< -o $@
$(BUILD)/contracts/check: $(TEST_O) $(CUT_O) $(EMU_O) $(ORC_O) $(WITHIN) $(INSIDE) $(ASSERTS)
	$(C17) $(TEST_O) $(CUT_O) $(EMU_O) $(ORC_O) $(WITHIN) $(ASSERTS) $(INSIDE) \
	  $(ASSERTED) -o $@ $(ORC_L) -lstdc++ -lm
$(BUILD)/contracts/outside: $(BUILD)/contracts/outside.o $(WITHIN) $(INSIDE) $(ASSERTS)
	$(C17) $(BUILD)/contracts/outside.o $(WITHIN) $(ASSERTS) $(INSIDE) $(ASSERTED) -o $@ -lm
# The same where only calls within a file are asserted.
$(BUILD)/contracts/inner: $(BUILD)/contracts/outside.o $(WITHIN) $(INSIDE) $(ASSERTS)
	$(C17) $(BUILD)/contracts/outside.o $(WITHIN) $(ASSERTS) $(INSIDE) \
	  $(shell python3 ci/eva/contracts.py real) -o $@ -lm
