#!/usr/bin/env bash
# Builds the Debian 13 root folder (Mesa from trixie-backports) that ./run and ./test enter with bubblewrap.
# usage: tools/make_root.sh ROOT_FOLDER PACKAGE_LIST…
# Works as root and, through user namespaces, as anybody else.
set -euo pipefail
root=$1
shift

# A host that already reads a Debian mirror names the nearest one; elsewhere mmdebstrap knows its own default.
host_mirror() {
    [ "$(. /etc/os-release && echo "$ID")" = debian ] || return 0
    { cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null || true; } |
        awk '/^(deb|URIs:) / { for (i = 2; i <= NF && !found; ++i) if ($i ~ /:\/\/.*\/debian\/?$/) { print $i; found = 1 } }'
}

stable=$(sed -e 's/#.*//' -e '/^ *$/d' -e '/\//d' "$@" | paste -sd,)
backported=$(sed -n 's/^\([^#]*\)\/trixie-backports$/\1/p' "$@" | paste -sd' ')
mirror=$(host_mirror)
mkdir -p "$(dirname "$root")"
work=$(mktemp -d "$root.XXXXXX")
trap 'rm -rf "$work"' EXIT

# The backports line is derived inside the root from the line that mmdebstrap wrote, so no mirror is named here.
# The archive is unpacked without device nodes and ownership, which a user without privileges may do too.
mkdir "$work/root"
mmdebstrap --quiet --variant=apt --include="$stable" --skip=output/dev \
    --aptopt='APT::Install-Recommends "false"' --aptopt='Acquire::Retries "3"' \
    --dpkgopt='force-unsafe-io' --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
    --customize-hook='sed -n "s/^\(deb .*\) trixie \(.*\)/\1 trixie-backports \2/p" "$1/etc/apt/sources.list" | head -n 1 >"$1/etc/apt/sources.list.d/backports.list"' \
    --customize-hook='chroot "$1" apt-get -q update' \
    --customize-hook="chroot \"\$1\" apt-get -q install -y --no-install-recommends -t trixie-backports $backported" \
    --customize-hook='chroot "$1" apt-get clean' \
    trixie - ${mirror:+"$mirror"} | tar -C "$work/root" --no-same-owner --exclude='./dev/*' -xf -
# Where another call was first, its root is as good. Without -T this one would land inside it.
[ -d "$root" ] || mv -T "$work/root" "$root" || [ -d "$root" ]
