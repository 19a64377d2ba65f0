#!/bin/bash
# Runs a script as root in a guest machine: Debian's kernel under qemu, this machine's own file system as its root (read
# only, with what the guest writes kept in memory). Needs no image, no root file system and no KVM.
#
#   guest.sh WORK-FOLDER SCRIPT [TIMEOUT-S]
#
# In the guest WORK-FOLDER is /share. Prints what the script prints and ends with its exit code.
set -euo pipefail
work=$(realpath "$1") script=$2 timeout_s=${3:-300}
cache=${RFMVO_GUEST_CACHE:-$(realpath "$(dirname "$0")/../..")/build/guest}
mkdir -p "$cache"

# The kernel that Debian ships now, unpacked, not installed.
fetch_kernel() {
  local package
  package=$(apt-cache depends linux-image-amd64 | sed -n 's/.*Depends: \(linux-image-[0-9].*-amd64\)$/\1/p' | head -1)
  (cd "$cache" && apt-get -o APT::Sandbox::User=root download "$package" >/dev/null && rm -rf kernel && dpkg-deb -x "$package"_*.deb kernel && rm ./*.deb)
  depmod -b "$cache/kernel" "$(ls "$cache/kernel/lib/modules")"
}

# An initial RAM disk of busybox and the modules that a root over 9p needs.
make_initrd() {
  local tree version file
  tree=$(mktemp -d)
  version=$(ls "$cache/kernel/lib/modules")
  mkdir -p "$tree/bin" "$tree/modules"
  cp /bin/busybox "$tree/bin/"
  for module in virtio_pci 9pnet_virtio 9p overlay; do
    modprobe -d "$cache/kernel" -S "$version" --show-depends "$module" | awk '$1 == "insmod" {print $2}'
  done | awk '!seen[$0]++' | while read -r file; do
    cp "$file" "$tree/modules/"
    basename "$file" >>"$tree/modules/order"
  done
  cat >"$tree/init" <<'INIT'
#!/bin/busybox sh
b=/bin/busybox
$b mkdir -p /proc /sys /dev /below /above /root
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
for module in $($b cat /modules/order); do $b insmod /modules/$module; done
p9=trans=virtio,version=9p2000.L,msize=512000
$b mount -t 9p -o ro,cache=loose,$p9 root /below || $b poweroff -f
$b mount -t tmpfs -o size=60% tmpfs /above
$b mkdir /above/upper /above/work
$b mount -t overlay -o lowerdir=/below,upperdir=/above/upper,workdir=/above/work overlay /root
$b mkdir -p /root/usr/lib/modules /root/share
$b mount -t 9p -o ro,cache=loose,$p9 modules /root/usr/lib/modules
$b mount -t 9p -o cache=none,access=any,$p9 work /root/share
for folder in proc sys dev; do $b mount --move /$folder /root/$folder; done
$b mount -t tmpfs tmpfs /root/run
$b mount -t tmpfs tmpfs /root/tmp
exec $b switch_root /root /share/.init
INIT
  chmod +x "$tree/init"
  (cd "$tree" && find . | cpio -o -H newc --quiet | gzip -1 >"$cache/initrd")
  rm -rf "$tree"
}

[ -d "$cache/kernel" ] || fetch_kernel
[ -e "$cache/initrd" ] || make_initrd

cp "$script" "$work/.script"
rm -f "$work/.code" "$work/.output"
cat >"$work/.init" <<'INIT'
#!/bin/sh
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C
echo 3 >/proc/sys/kernel/printk
bash /share/.script >/share/.output 2>&1
echo $? >/share/.code
sync
echo o >/proc/sysrq-trigger
while :; do sleep 60; done
INIT
chmod +x "$work/.init"

share() { echo -fsdev "local,id=$1,path=$2,security_model=none,multidevs=remap$3" -device "virtio-9p-pci,fsdev=$1,mount_tag=$1"; }
# shellcheck disable=SC2046
timeout "$timeout_s" qemu-system-x86_64 -machine q35 -cpu max -accel tcg,thread=multi -smp 2 -m 1024 -nodefaults \
  -display none -serial file:"$work/.console" -no-reboot -kernel "$cache"/kernel/boot/vmlinuz-* -initrd "$cache/initrd" \
  -append "console=ttyS0 panic=-1 quiet mitigations=off no5lvl edd=off" \
  $(share root / ,readonly=on) $(share modules "$cache/kernel/lib/modules" ,readonly=on) $(share work "$work" "") \
  </dev/null || echo "guest.sh: the guest did not end within $timeout_s s" >&2
cat "$work/.output" 2>/dev/null || tail -20 "$work/.console"
exit "$(cat "$work/.code" 2>/dev/null || echo 99)"
