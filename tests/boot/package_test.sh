#!/bin/bash
# Installs, upgrades and purges the box's package on a copy of this machine's file system that is gone afterwards (an
# overlay). Root only.
#
#   package_test.sh PACKAGE.deb
set -euo pipefail
deb=$(realpath "$1")
[ -n "${RFMVO_IN_OVERLAY:-}" ] || exec env RFMVO_IN_OVERLAY=1 unshare --mount --pid --fork "$0" "$deb"

space=$(mktemp -d)
mount -t tmpfs tmpfs "$space"
mkdir "$space/upper" "$space/work" "$space/root"
mount -t overlay -o "lowerdir=/,upperdir=$space/upper,workdir=$space/work" overlay "$space/root"
mount -t proc proc "$space/root/proc"
mount --bind /dev "$space/root/dev"
cp "$deb" "$space/root/first.deb"
# The next version: the same with another number, and another line in a file that its owner may have changed.
dpkg-deb -R "$deb" "$space/next"
sed -i 's/^Version: .*/Version: 99.0-1/' "$space/next/DEBIAN/control"
echo '# a line of the next version' >>"$space/next/etc/rfmvo/rfmvo.toml"
dpkg-deb -b --root-owner-group "$space/next" "$space/root/next.deb" >/dev/null

in_root() { chroot "$space/root" "$@"; }
fail() {
  echo "package_test.sh: $1" >&2
  exit 1
}

in_root dpkg -i /first.deb >/dev/null
in_root getent passwd rfmvo >/dev/null || fail "no user rfmvo"
in_root id -nG rfmvo | grep -qw video || fail "the user is not in the group video"
[ "$(in_root stat -c '%U %a' /var/lib/rfmvo)" = "rfmvo 750" ] || fail "/var/lib/rfmvo is not the user's own"
in_root test -e /etc/systemd/system/multi-user.target.wants/rfmvod.service || fail "not enabled"
in_root rfmvod --version

in_root sed -i 's/^address = .*/address = "192.168.7.7"/' /etc/rfmvo/rfmvo.toml
echo journal | in_root tee /var/lib/rfmvo/old.lcmlog >/dev/null
in_root systemctl --root=/ disable rfmvo-multicast.service 2>/dev/null
in_root dpkg -i --force-confdef --force-confold /next.deb >/dev/null
in_root grep -q 192.168.7.7 /etc/rfmvo/rfmvo.toml || fail "the upgrade has lost the owner's configuration"
in_root test -e /var/lib/rfmvo/old.lcmlog || fail "the upgrade has lost a journal"
in_root test ! -e /etc/systemd/system/multi-user.target.wants/rfmvo-multicast.service || fail "the upgrade has enabled what its owner disabled"

in_root dpkg -r rfmvo-firmware >/dev/null
in_root grep -q 192.168.7.7 /etc/rfmvo/rfmvo.toml || fail "a removal has lost the configuration"
in_root dpkg -P rfmvo-firmware >/dev/null
left=$(for path in /etc/rfmvo /var/lib/rfmvo /usr/bin/rfmvod /etc/chrony/conf.d/rfmvo.conf /etc/systemd/system/*/rfmvo* \
  /usr/lib/systemd/system/rfmvo* /var/lib/systemd/deb-systemd-helper-enabled/*rfmvo* \
  /var/lib/systemd/deb-systemd-helper-enabled/*/rfmvo* /usr/share/doc/rfmvo-firmware /usr/lib/udev/rules.d/*rfmvo*; do
  in_root sh -c "ls -d $path 2>/dev/null" || true
done)
[ -z "$left" ] || fail "left behind: $left"
echo "installed, upgraded, removed, purged: as it should be"
