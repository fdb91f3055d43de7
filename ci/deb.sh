#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages drape, libdrape* and libdrape-dev in BUILD/deb: the
# tree as git has it, with ci/debian as its debian/ and the version of
# spec/drape.h, through dpkg-buildpackage. lintian must find nothing, and the
# packages must hold what they say. Needs debhelper and lintian.
# usage: ci/deb.sh BUILD
set -eu
build=$1
for tool in dpkg-buildpackage:dpkg-dev dh:debhelper lintian:lintian; do
    command -v "${tool%:*}" >/dev/null || {
        echo "ci/deb.sh needs ${tool%:*}: apt-get install ${tool#*:}" >&2
        exit 1
    }
done
number() { sed -n "s/^#define DRAPE_VERSION_$1 //p" spec/drape.h; }
major=$(number MAJOR) minor=$(number MINOR)
version=$major.$minor.$(number PATCH)
abi=$major
[ "$major" -ne 0 ] || abi=$major.$minor # as in ci/install.mk

rm -rf "$build/deb"
mkdir -p "$build/deb/drape-$version"
if git ls-files >/dev/null 2>&1; then
    git ls-files -z --cached --others --exclude-standard |
        tar --null --files-from=- -c
else
    tar --exclude=./build --exclude="./$build" --exclude=__pycache__ -c .
fi >"$build/deb/tree.tar"
tar -x -f "$build/deb/tree.tar" -C "$build/deb/drape-$version"
rm "$build/deb/tree.tar"
(
    cd "$build/deb/drape-$version"
    cp -r ci/debian debian
    mv debian/libdrape.install "debian/libdrape$abi.install"
    date=$(git -C ../../.. log -1 --format=%cD 2>/dev/null || date -R)
    sed -i -e "s/@VERSION@/$version/" -e "s/@DATE@/$date/" debian/changelog
    # who makes the packages: as dch has it, else the author of the last commit,
    # else an address that lintian takes
    who=$(git -C ../../.. log -1 --format='%an <%ae>' 2>/dev/null ||
        echo 'drape <drape@no.example>')
    [ -z "${DEBEMAIL-}" ] || who="${DEBFULLNAME:-drape} <$DEBEMAIL>"
    sed -i -e "s/@ABI@/$abi/" -e "s/@WHO@/$who/" debian/control debian/changelog
    dpkg-buildpackage -us -uc -b -j"$(nproc)" >../build.log 2>&1 || {
        tail -n 30 ../build.log >&2
        exit 1
    }
    lintian --fail-on error,warning ../drape_*.changes
)
holds() {
    dpkg-deb -c "$build"/deb/"$1"_"$version"_*.deb | grep -e "$2" >/dev/null || {
        echo "$1 does not hold $2" >&2
        exit 1
    }
}
holds "libdrape$abi" "/libdrape.so.$abi -> libdrape.so.$version"
holds libdrape-dev /cmake/drape/drapeConfig.cmake
holds drape ./usr/bin/drape
ls "$build"/deb/*.deb
