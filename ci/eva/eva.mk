# SPDX-License-Identifier: Apache-2.0
# The debug flavour of the contracts in ref/ (ci/eva/contracts.py): build/check and a
# program of calls outside of them, linked so that calls from other files pass through
# functions that assert the contract. No object of the library is compiled anew.

CONTRACT_H := $(addprefix ref/narrow/,closest.h filter.h split.h predicates.h tritri.h)
ASSERTS    := $(BUILD)/contracts/asserts.32.o $(BUILD)/contracts/asserts.64.o
ASSERTED    = $(shell python3 ci/eva/contracts.py flags)

$(BUILD)/contracts/asserts.%.c: ci/eva/contracts.py $(CONTRACT_H)
	@mkdir -p $(@D)
	$(call show,ASSERTS $@)python3 ci/eva/contracts.py asserts $* >$@
$(ASSERTS): $(BUILD)/contracts/asserts.%.o: $(BUILD)/contracts/asserts.%.c | $(NAMES)
	$(C17) -DREAL_BITS=$* -c $< -o $@
$(BUILD)/contracts/outside.o: ci/eva/outside.c $(CONTRACT_H) | $(NAMES)
	@mkdir -p $(@D)
	$(C17) -DREAL_BITS=64 -c $< -o $@
$(BUILD)/contracts/check: $(TEST_O) $(CUT_O) $(EMU_O) $(ORC_O) $(INSIDE) $(ASSERTS)
	$(C17) $(TEST_O) $(CUT_O) $(EMU_O) $(ORC_O) $(ASSERTS) $(INSIDE) $(ASSERTED) -o $@ \
	  $(ORC_L) -lstdc++ -lm
$(BUILD)/contracts/outside: $(BUILD)/contracts/outside.o $(INSIDE) $(ASSERTS)
	$(C17) $(BUILD)/contracts/outside.o $(ASSERTS) $(INSIDE) $(ASSERTED) -o $@ -lm
