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
