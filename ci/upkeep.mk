# SPDX-License-Identifier: Apache-2.0
# What is recorded, certified, proved or formatted anew, and the longest tests.

.PHONY: golden reference certify prove mutants soak format tidy
golden: $(BUILD)/check ## records the hashes of all stages anew
	$(BUILD)/check --golden-write tests/golden/stages.txt

reference: $(BUILD)/drape ## scenes of certify by ref/: ci/reference.txt, an hour
	sh ci/certify.sh $(BUILD) none reference

certify: ## compares ref and gpu on the device: ci/certificate.json
	$(MAKE) GPU=yes $(BUILD)/check-cuda $(BUILD)/drape
	sh ci/certify.sh $(BUILD) ci/certificate.json

prove: ## Gappa bounds the filters' constants; kernels are ref's, for every input
	sh ci/prove.sh --coq $(BUILD)
	sh ci/eva/eva.sh $(BUILD)
	python3 ci/models/models.py $(BUILD)
	sh ci/equal/prove.sh $(BUILD) $(if $(WRITE),--write)

N ?= 60
SEED ?= 1
mutants: ## plants N=60 faults in changed lines (ALL=1: in any) by SEED=: who sees?
	python3 ci/mutants.py -n $(N) --seed $(SEED) $(if $(ALL),--all) \
	  $(if $(BASE),--base $(BASE)) --work $(BUILD)/mutants

soak: check-parts ## the tests under sanitizers, and their long forms
	sh ci/flavour.sh $(BUILD) asan yes
	OMP_WAIT_POLICY=passive UBSAN_OPTIONS=print_stacktrace=1 \
	  $(BUILD)/asan/check --tests
	DRAPE_SOAK=1 $(BUILD)/check --tests

format: ## clang-format everything in place
	clang-format -i $(wildcard app/*/*.[ch] app/examples/*.c[pu]* bench/*.[ch] \
	  fuzz/*.[ch] \
	  gpu/*/* oracle/*.[ch]* python/core/*.[ch] ref/*/*.[ch] spec/*.h tests/*/*.[ch])

# The analyzer's search is cut at 20000 nodes (225000 usually) for the time
# it takes: paths that only a longer search finds are not looked at.
TIDY := -std=c17 -I. -Ispec -I$(BUILD) -D_POSIX_C_SOURCE=200809L \
        -DEMBREE=$(EMBREE) \
        -Xclang -analyzer-config -Xclang max-nodes=20000
# Python.h is not everywhere.
TIDY_CORE := $(filter-out %/tensor.c,$(wildcard python/core/*.c))
tidy: $(BUILD)/words.h $(BUILD)/speed.inc $(NAMES) ## clang-tidy over our C
	ls app/*/*.c fuzz/*.c $(TIDY_CORE) ref/*/*.c tests/*/*.c | \
	  xargs -P2 -n8 sh -c 'clang-tidy --quiet "$$@" -- $(TIDY) 2>/dev/null' sh
