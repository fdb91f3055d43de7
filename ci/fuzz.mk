# SPDX-License-Identifier: Apache-2.0
# The program that replays the corpora of fuzz/, and what ci/fuzz.sh links with
# libFuzzer: everything but the main functions, in both precisions.

.PHONY: fuzz fuzz-soak fuzz-libs corpus
TARGETS := bank bodies calls create damage draw live load many queries reads \
           replay small stage step table whole worlds
READERS := checkpoint csv files mutate part pattern readers report strict
PARTS := $(filter-out $(addprefix $(BUILD)/tests/base/,check.o certify.o), \
         $(TEST_O)) $(REF_O) $(EMU_O) $(ORC_O) \
         $(call obj,$(addprefix fuzz/,$(TARGETS))) \
         $(if $(HAS_APP),$(filter-out $(BUILD)/app/tool/main.o,$(APP_O)) \
         $(call obj,$(addprefix fuzz/,$(READERS))),$(BUILD)/fuzz/absent.o)
FUZZ_L := $(ORC_L) $(if $(HAS_APP),$(APP_LIBS)) -lstdc++ -lm
# Comparisons are not traced where there are millions of them: ci/fuzz.sh.
$(BUILD)/ref/%.o $(BUILD)/tests/%.o: MODEL += $(UNTRACED)
# The words of the pages on scenes and patterns, for those who change these.
$(BUILD)/words.h: app/scenes/README.md app/patterns/README.md
	@mkdir -p $(@D)
	$(call show,MAKE $@)grep -oh '`[^` ]*`' $^ | tr -d '`"' | grep -x '[a-z0-9_-]*' | sort -u | \
	  sed 's/.*/"&",/' >$@
$(BUILD)/fuzz/mutate.o: $(BUILD)/words.h
$(BUILD)/parts.a: $(PARTS)
	@rm -f $@
	$(call show,AR $@)$(AR) rcs $@ $^
$(BUILD)/replay: $(BUILD)/fuzz/main.o $(BUILD)/parts.a
	$(C17) $^ -o $@ $(FUZZ_L)
# The corpora, unpacked: fuzz/corpus.py.
$(BUILD)/corpus/%.made: fuzz/corpus/%.tar
	@rm -rf $(@:.made=) && mkdir -p $(@:.made=)
	$(call show,TAR $<)tar -xf $< -C $(@:.made=) --no-same-owner
	@touch $@
corpus: $(patsubst %.tar,$(BUILD)/%.made,$(subst fuzz/,,$(wildcard \
    fuzz/corpus/*.tar))) # in BUILD/corpus
fuzz-libs: # what links with parts.a, for ci/fuzz.sh
	@echo $(FUZZ_L)
fuzz: ## T=target S=seconds: libFuzzer on one target
	@sh ci/fuzz.sh $(BUILD) $(T) $(S)
fuzz-soak: ## an hour, or S=seconds, on the targets with the fewest hours, or T=targets
	@sh ci/fuzz.sh $(BUILD) soak $(or $(S),3600) $(T)
