# SPDX-License-Identifier: Apache-2.0
# Flavours of the build: the same sources by another compiler, by other flags
# or under a sanitizer, each with objects of its own in BUILD/NAME. A flavour is
# the Makefile again with another BUILD. ci/flavour.sh says what each must do.
#
# A flavour compiles everything of ref/ and tests/whole/, some app/, too. The tests and
# the emulated kernels are ROOT's, but where TEST_IN or EMU_IN says otherwise;
# the oracles, which take a minute to compile, are always ROOT's.

PLAIN    := gcc-O0 gcc-O3 clang-O0 clang-O2 clang-O3
FLAVOURS := $(PLAIN) asan tsan msan
.PHONY: flavours $(FLAVOURS) clang-tests pure coverage

flavours: check-parts ## gcc and clang, -O0 to -O3, three sanitizers
	for f in $(FLAVOURS); do sh ci/flavour.sh $(BUILD) $$f || exit 1; done

# What a flavour's library must say of itself: ci/pure.sh.
RECORD = -frecord-gcc-switches
# By clang -O0 kernels, too: there both precisions may emit symbols of one name, and
# a mix-up shows; and what nobody has set begins with a pattern and not with what a
# call before left there. (Built so by gcc 12, with zeros as well, coarsen.cu fails
# its comparison.)
gcc-O0:   HOW = CC=gcc CXX=g++ OPT='-O0 $(RECORD)'
gcc-O3:   HOW = CC=gcc CXX=g++ OPT='-O3 -march=native $(RECORD)'
clang-O0: HOW = CC=clang CXX=clang++ EMU_IN=$(BUILD)/$@ \
	  OPT='-O0 -ftrivial-auto-var-init=pattern $(RECORD)'
clang-O2: HOW = CC=clang OPT='-O2 $(RECORD)'
clang-O3: HOW = CC=clang OPT='-O3 -march=native $(RECORD)'
# KERNELS= leaves the emulated kernels and the tests themselves without
# sanitizers, as check does but for CI. With sanitizers they take longer to compile
# than to run, and -O0 halves that.
KERNELS ?= yes
asan: HOW = CC=gcc CXX=g++ OPT='-O1 -g1 $(RECORD)' $(if $(KERNELS),\
	  EMU_IN=$(BUILD)/asan TEST_IN=$(BUILD)/asan EMU_LEVEL='-O0 -g1' TEST_LEVEL=-O0) \
	  SAN='-fsanitize=address,undefined -fno-sanitize-recover=all'
tsan: HOW = CC=clang OPT='-O1 -g1 $(RECORD)' SAN=-fsanitize=thread
# It knows no memory that another library writes, so OpenMP's is left out.
msan: HOW = CC=clang OPT='-O1 -g1 $(RECORD)' SAN=-fsanitize=memory \
	  OPENMP=-Wno-source-uses-openmp

# The tool by one plain flavour of each compiler. Neither TSan nor MSan can look into
# its libraries.
$(PLAIN): GOALS = check whole
gcc-O3 clang-O0 asan: GOALS = check whole $(if $(HAS_APP),drape)
tsan msan: GOALS = whole
# libomp answers the calls of gcc's objects too.
$(PLAIN) asan: $(BUILD)/check
clang-O2: clang-tests
$(FLAVOURS):
	$(MAKE) ROOT=$(ROOT) EMU_IN=$(ROOT) TEST_IN=$(ROOT) BUILD=$(BUILD)/$@ \
	  GPU= $(HOW) $(addprefix $(BUILD)/$@/,$(GOALS)) pure

# clang's warnings about the tests, which no flavour compiles by clang.
clang-tests: $(BUILD)/certificate.h $(NAMES)
	for bits in 32 64; do clang -std=c17 -D_POSIX_C_SOURCE=200809L $(WARN) \
	  $(OPENMP) -I. -Ispec -I$(BUILD) -fsyntax-only -DREAL_BITS=$$bits \
	  $(TWICE) $(ONCE) || exit 1; done

# Whether the library holds all of ref/, and nothing that others have compiled.
pure: $(INSIDE)
	sh ci/pure.sh $(INSIDE) '$(CC)' '$(OPT) $(SAN)' $(notdir $(REF_O)) absent.o

# What ROOT's build makes of the small scenes: what all others must make.
$(BUILD)/whole.txt: $(BUILD)/whole
	$(call show,RUN $(BUILD)/whole)OMP_WAIT_POLICY=passive $(BUILD)/whole >$@

coverage: ## which lines of ref/ the small scenes of tests/whole leave out
	rm -rf $(BUILD)/coverage
	$(MAKE) ROOT=$(ROOT) BUILD=$(BUILD)/coverage GPU= CC=gcc OPT=-O0 \
	  SAN=--coverage $(BUILD)/coverage/whole
	$(BUILD)/coverage/whole >$(BUILD)/coverage/whole.txt
	cd $(BUILD)/coverage && gcov -s $(CURDIR) -r ref/*/*.gcno | \
	  grep -A1 "^File 'ref/.*c'"
