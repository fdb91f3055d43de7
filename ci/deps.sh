#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the packages that drape is built and tested with, on Debian 12 or 13, and
# says every ten seconds how far apt is; prints nothing if none is missing. The library
# itself needs only a C compiler.
# `apps`: what the tests of export, viewer, Blender add-on and notebook need
# besides; `slurm`: what those of sweeps by Slurm need; `proofs`: what make prove needs
# for Coq and Frama-C. These are skipped without. `bare`: what ci/bare.sh needs.
# usage: ci/deps.sh [apps|slurm|proofs|bare]
set -eu
need='gcc g++ make clang clang-format clang-tidy libomp-dev
      libassimp-dev libjansson-dev libembree-dev libpng-dev ffmpeg
      libcgal-dev libfcl-dev libccd-dev libgmp-dev libmpfr-dev gappa spin
      libclang-rt-dev python3 python3-dev python3-venv cmake pkg-config'
[ "${1-}" != bare ] || need='mmdebstrap git'
[ "${1-}" != proofs ] || need='frama-c-base coq libcoq-flocq libcoq-gappa'
[ "${1-}" != slurm ] || need='slurm-wlm munge'
[ "${1-}" != apps ] || need='chromium libatomic1 python3-torch libgl1 libsm6 libice6 libx11-6 libxext6
      libxfixes3 libxi6 libxkbcommon0 libxrender1'
missing=
for package in $need; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) ||
        state=absent
    [ "$state" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0
install="apt-get update && apt-get install -y --no-install-recommends$missing"
if [ "$(id -u)" -eq 0 ]; then
    as=
elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
    as=sudo
else
    echo "drape needs:$missing" >&2
    echo "Type: sudo sh -c '$install'" >&2
    exit 1
fi
echo "installing, which takes some minutes:$missing"
log=/tmp/drape-deps.$$
$as sh -c "export DEBIAN_FRONTEND=noninteractive; $install" >$log 2>&1 &
apt=$!
trap 'kill $apt; exit 130' INT TERM # a background job does not hear Ctrl-C
seconds=0
while kill -0 $apt 2>/dev/null; do
    sleep 1
    seconds=$((seconds + 1))
    [ $((seconds % 10)) -ne 0 ] || echo "  $(tail -n 1 $log | cut -c 1-77)"
done
wait $apt || {
    tail -n 20 $log >&2
    exit 1
}
rm -f $log
