# SPDX-License-Identifier: Apache-2.0
# What nvcc makes of the kernels, as PTX by the flags of the build. ci/equal/lint.py
# checks its operations.

.PHONY: ptx
TO_PTX = $(filter-out -gencode arch=%,$(CUDA)) -arch=compute_$(lastword $(REALS)) -ptx
PTX   := $(addprefix $(BUILD)/ptx/,$(addsuffix .ptx,$(basename $(DEVICE)) \
         $(foreach bits,32 64,$(addsuffix .$(bits),$(basename $(KERNEL))))))

ptx: $(PTX) ## PTX of every kernel, in BUILD/ptx; needs nvcc, but no device
define ptx_of
$(BUILD)/ptx/%$(1:%=.%).ptx: %.cu | $(NAMES)
	@mkdir -p $$(@D)
	$$(call show,PTX $$<$$(bits))$$(TO_PTX) $(1:%=-DREAL_BITS=%) $$< -o $$@
endef
$(foreach bits,32 64,$(eval $(call ptx_of,$(bits))))
$(eval $(call ptx_of))
$(BUILD)/ptx/gpu/run/device.ptx: $(BUILD)/certificate.h
-include $(PTX:.ptx=.d)

# The wrappers that ci/equal/table.py writes: the device's side by nvcc, and the
# reference's by clang.
TO_LLVM = clang -std=c17 -D_POSIX_C_SOURCE=200809L -O0 -gline-tables-only $(MODEL) \
          -fno-discard-value-names -w -I. -Ispec -I$(BUILD) -MMD -MP -S -emit-llvm
define twin_of
$(BUILD)/equal/%.$(1).ptx: $(BUILD)/equal/%.cu | $(NAMES)
	$$(call show,PTX $$<$$(bits))$$(TO_PTX) -DREAL_BITS=$(1) $$< -o $$@
$(BUILD)/equal/%.$(1).ll: $(BUILD)/equal/%.c | $(NAMES)
	$$(call show,LLVM $$<$$(bits))$$(TO_LLVM) -MF $$@.d -DREAL_BITS=$(1) $$< -o $$@
endef
$(foreach bits,32 64,$(eval $(call twin_of,$(bits))))
# Machine code of the wrappers for one kind of device, which ci/equal/sass.py reads.
TO_CUBIN = $(filter-out -lineinfo -arch=% -ptx,$(TO_PTX)) -arch=sm_90 -cubin
define cubin_of
$(BUILD)/equal/%.$(1).cubin: $(BUILD)/equal/%.cu | $(NAMES)
	$$(call show,CUBIN $$<$$(bits))$$(TO_CUBIN) -DREAL_BITS=$(1) $$< -o $$@
endef
$(foreach bits,32 64,$(eval $(call cubin_of,$(bits))))
-include $(wildcard $(BUILD)/equal/*.d)

# The device's side again, with other words in place of one of nvcc's command:
# ci/equal/versions.py compares both.
TO_AGAIN = $(if $(filter $(SWAP),$(TO_PTX)),$(patsubst $(SWAP),$(FOR),$(TO_PTX)),\
           $(error nvcc's command has no $(SWAP)))
define again_of
$(BUILD)/equal/again/%.$(1).ptx: $(BUILD)/equal/%.cu | $(NAMES)
	$$(call show,AGAIN $$<$$(bits))$$(TO_AGAIN) -DREAL_BITS=$(1) $$< -o $$@
$(BUILD)/equal/again/%.$(1).ptx: %.cu | $(NAMES)
	@mkdir -p $$(@D)
	$$(call show,AGAIN $$<$$(bits))$$(TO_AGAIN) -DREAL_BITS=$(1) $$< -o $$@
endef
$(foreach bits,32 64,$(eval $(call again_of,$(bits))))
