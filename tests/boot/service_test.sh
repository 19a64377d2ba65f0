#!/bin/bash
# The box's package in a container that systemd boots, on a copy of this machine's file system that is gone afterwards:
# the hardened unit starts, systemd's watchdog catches a daemon that hangs, SIGTERM ends it within two seconds. Root
# only; no camera there, which the service must survive.
#
#   service_test.sh PACKAGE.deb
set -euo pipefail
deb=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
[ -n "${RFMVO_IN_OVERLAY:-}" ] || exec env RFMVO_IN_OVERLAY=1 unshare --mount "$here/service_test.sh" "$deb"

space=$(mktemp -d)
mount -t tmpfs tmpfs "$space"
mkdir "$space/upper" "$space/work" "$space/root" "$space/share"
mount -t overlay -o "lowerdir=/,upperdir=$space/upper,workdir=$space/work" overlay "$space/root"
cp "$deb" "$space/root/box.deb"
chroot "$space/root" dpkg -i /box.deb >/dev/null 2>&1
# The example of the README, for the default picture.
sed -n '/^cat >\/tmp\/calibration.toml/,/^TOML/p' "$here/camera_guest.sh" | sed '1d;$d' |
  sed 's/^width_px.*/width_px = 640/; s/^height_px.*/height_px = 480/' >"$space/root/etc/rfmvo/calibration.toml"
sed -i 's/^source = .*/source = "v4l2:\/dev\/video0"/' "$space/root/etc/rfmvo/rfmvo.toml"
# Half a minute is long for a test.
mkdir -p "$space/root/etc/systemd/system/rfmvod.service.d"
printf '[Service]\nWatchdogSec=6\n' >"$space/root/etc/systemd/system/rfmvod.service.d/test.conf"

cat >"$space/root/in_container.sh" <<'TEST'
set -u
exec >/share/output 2>&1
fail() {
  echo "service_test.sh: $1"
  systemctl status rfmvod --no-pager -l
  journalctl -u rfmvod --no-pager | tail -20
  echo 1 >/share/code
  systemctl poweroff
  exit
}
show() { systemctl show -P "$1" rfmvod; }
for _ in $(seq 100); do [ "$(show ActiveState)" = active ] && break; sleep 0.2; done
[ "$(show ActiveState)" = active ] || fail "it does not start"
echo "ready $(($(show ActiveEnterTimestampMonotonic) - $(show ExecMainStartTimestampMonotonic))) us after its start, as $(ps -o user= -p "$(show MainPID)")"
sleep 2
echo "status: $(show StatusText)"
ip route show 224.0.0.0/4 | grep -q lo || fail "no multicast route"
ls /var/lib/rfmvo/*.tmp >/dev/null || fail "no journal"
kill -STOP "$(show MainPID)"
for _ in $(seq 150); do [ "$(show NRestarts)" = 1 ] && [ "$(show ActiveState)" = active ] && break; sleep 0.2; done
[ "$(show NRestarts)" = 1 ] || fail "the watchdog has not seen that it hangs"
echo "hung: killed by the watchdog and started anew"
ls /var/lib/rfmvo/*.lcmlog >/dev/null || fail "the journal of the killed one was not put in order"
from=$(date +%s%N)
systemctl stop rfmvod
echo "stopped within $((($(date +%s%N) - from) / 1000000)) ms"
[ "$(show Result)" = success ] || fail "it does not end well: $(show Result)"
ls /var/lib/rfmvo/*.tmp >/dev/null 2>&1 && fail "the journal was not closed"
echo 0 >/share/code
systemctl poweroff
TEST
cat >"$space/root/etc/systemd/system/in-container.service" <<'UNIT'
[Unit]
After=multi-user.target
[Service]
Type=exec
ExecStart=/bin/bash /in_container.sh
UNIT
mkdir -p "$space/root/etc/systemd/system/multi-user.target.wants"
ln -sf ../in-container.service "$space/root/etc/systemd/system/multi-user.target.wants/"
rm -f "$space/root/etc/systemd/system/default.target"
ln -s /lib/systemd/system/multi-user.target "$space/root/etc/systemd/system/default.target"

timeout 240 systemd-nspawn -q -D "$space/root" --register=no --keep-unit --private-network --bind="$space/share:/share" \
  -b </dev/null >"$space/console" 2>&1 || true
cat "$space/share/output" 2>/dev/null || tail -20 "$space/console"
exit "$(cat "$space/share/code" 2>/dev/null || echo 99)"
