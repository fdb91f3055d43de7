#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Types commands in a bare Debian of its own making: mmdebstrap's smallest, with git
# alone, and in it a clone of what is committed here. So README's commands are tried
# as a newcomer tries them: with no package, file or setting of this machine but its
# certificates and its way to the network. Run as root. WERROR and CI are passed on.
# The folder DRAPE_DATA, if there is one, is /data there, and no variable says so.
# BUILD/bare-VERSION takes 6 GB and is gone at the end.
# usage: ci/bare.sh BUILD 12|13 COMMAND...
# Its exit status is 1 if a command fails, and 77 if no such Debian can be made here.
set -u
build=$1 version=$2
shift 2
. ci/release.sh
cannot() {
    echo "$0: no bare Debian $version here: $1" >&2
    exit 77
}
[ "$(id -u)" -eq 0 ] || cannot 'it takes root'
command -v mmdebstrap >/dev/null || cannot 'there is no mmdebstrap (sh ci/deps.sh bare)'
mkdir -p "$build"
work=$(cd "$build" && pwd)/bare-$version
root=$work/root log=$work/log
rm -rf --one-file-system "$work"
mkdir -p "$work"
trap 'rm -rf --one-file-system "$work"' EXIT
trap 'exit 130' INT TERM

echo "Debian $version, bare"
mmdebstrap --variant=minbase --include=git,ca-certificates \
    --dpkgopt=force-unsafe-io $name "$root" >"$log" 2>&1 || cannot "mmdebstrap: $(tail -n 1 "$log")"
git config --file "$work/.gitconfig" safe.directory '*' # another's checkout, too
HOME=$work git clone -q --no-local . "$root/root/drape" 2>"$log" ||
    cannot "git: $(tail -n 1 "$log")"
cp /etc/resolv.conf "$root/etc/resolv.conf"
certificates=/etc/ssl/certs/ca-certificates.crt
[ ! -e $certificates ] || cp $certificates "$root$certificates"
env | grep -E '^(WERROR|CI|[a-z]+_proxy)=' >"$root/root/env"
echo "PIP_CERT=$certificates" >>"$root/root/env"
mkdir "$root/data"
data=${DRAPE_DATA-}
[ -d "$data" ] || data=$root/data

# Mounts and processes are this command's own and end with it.
inside() {
    # shellcheck disable=SC2016
    unshare --mount --pid --fork --kill-child sh -c '
        mount -t proc proc "$1/proc" && mount --rbind /sys "$1/sys" &&
            mount --rbind /dev "$1/dev" && mount --bind "$3" "$1/data" || exit 77
        exec env -i HOME=/root TERM="${TERM-dumb}" \
            PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
            $(cat "$1/root/env") chroot "$1" sh -c "cd /root/drape && $2"' \
        sh "$root" "$1" "$data"
}
inside true 2>"$log" || cannot "a chroot: $(tail -n 1 "$log")"
for command; do
    start=$(date +%s)
    echo "\$ $command"
    inside "$command"
    status=$?
    echo "$command: exit status $status, $(($(date +%s) - start)) s"
    [ $status -eq 0 ] || exit 1
done
