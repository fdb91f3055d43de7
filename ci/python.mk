# SPDX-License-Identifier: Apache-2.0
# The Python package of python/: what its extension is linked of, its wheel and
# its tests. python/README.md says how they fit together.

.PHONY: wheel sdist venv blender check-python docs python-core
PY     := $(BUILD)/python
PIP    := $(PY)/venv/bin/python -m pip install -q

# The tool's reader of scenes and writer of runs, which the extension shares: its
# rooms before render/, but for what assimp reads.
CORE   := $(filter-out app/read/assimp.c app/read/pose.c app/render/% app/tool/%, \
          $(APP)) python/core/log.c
HAS_ASSIMP := $(call has,assimp/cimport.h)
CORE   += $(if $(HAS_ASSIMP),app/read/assimp.c app/read/pose.c,python/core/absent.c)
CORE_L := $(if $(HAS_ASSIMP),-lassimp) -ljansson -lpthread $(if $(GPU),$(CUDA_L),-lm)

# Prints what setup.py links: objects and libraries, then macros; and the tool.
python-core: $(call obj,$(CORE),) $(LIB) $(if $(HAS_APP),$(BUILD)/drape)
	@echo 'link $(filter %.o %.a,$^) $(CORE_L)'
	@echo 'compile $(if $(GPU),-DDRAPE_CUDA \
	  -I$(dir $(realpath $(NVCC)))../include)'
	@echo 'tool $(if $(HAS_APP),$(BUILD)/drape)'

# What builds the package, in an environment of its own.
$(PY)/venv/made: python/requirements.txt
	$(call show,MAKE $(PY)/venv)python3 -m venv $(PY)/venv
	@$(PIP) -r $<
	@touch $@

# The package of this tree as programs of it import it, without a wheel. A folder that
# pip has left says nothing of what the extension is linked of now.
PACKAGE := $(PY)/package
$(PACKAGE)/made: $(PY)/venv/made $(LIB) $(call obj,$(CORE),) $(HAS_APP:%=$(BUILD)/drape) \
    $(wildcard python/*.py python/core/* python/drape/*.py python/drape/*/*.py)
	$(call show,MAKE $(PACKAGE))rm -rf python/build $(PACKAGE)
	@DRAPE_BUILD=$(BUILD) DRAPE_MAKE="GPU=$(GPU) $${DRAPE_MAKE-}" $(PIP) install \
	  --no-deps --no-build-isolation --target $(PACKAGE) ./python
	@touch $@

# A wheel with the device's part says by which CUDA: drape_cloth-0.1.0+cu130-….whl.
DIST ?= dist
WITH_CUDA = $(if $(GPU),cu$(shell nvcc --version | sed -n \
            's/.*release \([0-9]*\)\.\([0-9]*\).*/\1\2/p'))
wheel: $(PY)/venv/made ## a wheel of the Python package, in DIST=dist
	$(call show,MAKE $(DIST)/*.whl)DRAPE_MAKE="GPU=$(GPU) $${DRAPE_MAKE-}" DRAPE_LOCAL=$(WITH_CUDA) \
	  sh python/wheel.sh $(BUILD) $(DIST)

# What PyPI takes: `make wheel sdist`. The archive builds a wheel by pip, where a C
# compiler, make and the headers of jansson are.
sdist: $(PY)/venv/made ## an archive of the sources for PyPI, in DIST=dist
	$(call show,MAKE $(DIST)/*.tar.gz)rm -f $(DIST)/drape_cloth-*.tar.gz && \
	  $(PY)/venv/bin/python -m build -q --sdist --no-isolation \
	  --outdir $(DIST) . >$(PY)/sdist.log 2>&1 || { cat $(PY)/sdist.log; exit 1; }
	@$(PY)/venv/bin/twine check --strict $(DIST)/*

# Debian's own Python takes no packages, so there is an environment for them.
venv: wheel ## the package with its view and export: BUILD/venv/bin/drape, …/python
	$(call show,MAKE $(BUILD)/venv)rm -rf $(BUILD)/venv && \
	  python3 -m venv $(BUILD)/venv && $(BUILD)/venv/bin/python -m pip \
	  install -q "$$(ls $(DIST)/*.whl)[view,export]"
	@echo '$(BUILD)/venv/bin/drape view DIR; $(BUILD)/venv/bin/python: import drape'

# Of the Python that Blender 4.2 to 5.0 have; NumPy is Blender's own.
blender: wheel ## the extension for Blender: BUILD/drape-blender.zip
	@rm -rf $(PY)/blender
	@$(PY)/venv/bin/pip download -q -d $(PY)/blender --only-binary :all: \
	  --python-version 3.11 cffi
	$(call show,PACK $(BUILD)/drape-blender.zip)python3 app/blender/pack.py \
	  $(BUILD)/drape-blender.zip $(DIST)/drape_cloth-*.whl $(PY)/blender/*.whl

check-python: $(PY)/venv/made ## tests the package's wheel in a fresh environment
	@sh python/check.sh $(BUILD)

docs: wheel ## the documentation site: build/python/site/index.html
	@sh python/docs.sh $(BUILD)
