# SPDX-License-Identifier: Apache-2.0
# The shared library, what `make install` installs, the packages, and what `make`
# says at its end of the parts that it did not build.

.PHONY: say install deb docker

# The version is spec/drape.h's. While its first number is 0, a new second number
# may change the API, so the soname has both.
number  = $(shell sed -n 's/^\#define DRAPE_VERSION_$(1) //p' spec/drape.h)
VERSION := $(call number,MAJOR).$(call number,MINOR).$(call number,PATCH)
ABI     := $(call number,MAJOR)$(if $(filter 0,$(call number,MAJOR)),.$(\
           )$(call number,MINOR))
SO      := $(BUILD)/libdrape.so
# The CUDA runtime is a part of the library, and its names stay inside.
$(SO): $(BUILD)/libdrape.o
	$(call show,LINK $@)$(CC) -shared $(OPT) $(CFLAGS) $(LDFLAGS) $(SAN) -Wl,-soname,libdrape.so.$(ABI) \
	  -Wl,-z,defs -Wl,--exclude-libs,ALL $< -o $@ -pthread \
	  $(if $(GPU),$(CUDA_L),-lm)

# Names of the Debian packages for the headers that the tool and the oracles want.
package = $(or $(word 2,$(subst :, ,$(filter $(1):%,\
  assimp/cimport.h:libassimp-dev jansson.h:libjansson-dev png.h:libpng-dev \
  embree3/rtcore.h:libembree-dev embree4/rtcore.h:libembree-dev gmp.h:libgmp-dev \
  CGAL/version.h:libcgal-dev Eigen/Dense:libeigen3-dev fcl/fcl.h:libfcl-dev \
  ccd/ccd.h:libccd-dev mpfr.h:libmpfr-dev))),$(1))
lacks   = $(foreach h,$(1),$(if $(call has,$(h)),,$(call package,$(h))))
say: $(LIB) $(SO) $(BUILD)/check $(if $(HAS_APP),$(BUILD)/drape)
	@echo 'drape: built $(LIB), $(SO), $(BUILD)/check$(if \
	  $(HAS_APP),$(comma) $(BUILD)/drape)$(if $(GPU), with the GPU part)'
	@$(if $(GPU),,echo 'drape: NOT BUILT: the GPU part: $(if $(NVCC),there is \
	  no NVIDIA device here (GPU=yes builds it all the same),there is no nvcc here)')
	@$(if $(HAS_APP),,echo 'drape: NOT BUILT: the tool $(BUILD)/drape: there are \
	  no headers of: $(call lacks,$(APP_H)) (sh ci/deps.sh installs them)')
	@$(if $(HAS_ORACLE),,echo 'drape: NOT BUILT: the oracles of the tests: there \
	  are no headers of: $(call lacks,$(ORACLE_H)) (sh ci/deps.sh installs them)')

# LIBDIR is below PREFIX: lib/x86_64-linux-gnu, say. What is installed finds its
# prefix by as many steps upwards, so that the whole may be moved.
LIBDIR ?= lib
space  := $(subst ,, )
UP     := $(subst $(space),/,$(foreach step,$(subst /, ,$(LIBDIR)),..))
TO      = $(DESTDIR)$(PREFIX)
fill    = sed -e 's|@VERSION@|$(VERSION)|g' -e 's|@ABI@|$(ABI)|g' \
          -e 's|@UP@|$(UP)|g' -e 's|@LIBDIR@|$(LIBDIR)|g' \
          -e 's|@LIBS@|$(if $(GPU),$(CUDA_L),-lm)|g' ci/install/$(1).in \
          >"$(TO)/$(LIBDIR)/$(2)/$(1)"
install: $(LIB) $(SO) ## to $(DESTDIR)$(PREFIX): libraries, header, tool, man page
	install -d "$(TO)/$(LIBDIR)/pkgconfig" "$(TO)/$(LIBDIR)/cmake/drape"
	install -m 644 $(LIB) "$(TO)/$(LIBDIR)/libdrape.a"
	install -m 644 $(SO) "$(TO)/$(LIBDIR)/libdrape.so.$(VERSION)"
	ln -sf libdrape.so.$(VERSION) "$(TO)/$(LIBDIR)/libdrape.so.$(ABI)"
	ln -sf libdrape.so.$(ABI) "$(TO)/$(LIBDIR)/libdrape.so"
	install -D -m 644 spec/drape.h "$(TO)/include/drape.h"
	@$(call fill,drape.pc,pkgconfig)
	@$(call fill,drapeConfig.cmake,cmake/drape)
	@$(call fill,drapeConfigVersion.cmake,cmake/drape)
	test ! -x $(BUILD)/drape || install -D $(BUILD)/drape "$(TO)/bin/drape"
	install -D -m 644 app/drape.1 "$(TO)/share/man/man1/drape.1"
	install -d "$(TO)/share/drape"
	install -m 755 ci/data.sh ci/lion.sh "$(TO)/share/drape"
	install -m 644 ci/data.py "$(TO)/share/drape"

deb: ## Debian packages in BUILD/deb, by dpkg-buildpackage, looked at by lintian
	sh ci/deb.sh $(BUILD)

docker: ## an image `drape` with the tool and the library: ci/container/Dockerfile
	docker build -t drape -f ci/container/Dockerfile .
