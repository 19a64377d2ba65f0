# In the guest: rfmvod on a real V4L2 driver (vivid), with the troubles that it can make. Called by guest.sh.
set -eu
program=/share/rfmvod
modprobe vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=0x0
for _ in $(seq 100); do [ -e /dev/video0 ] && break; sleep 0.1; done

cat >/tmp/calibration.toml <<'TOML'
[camera]
model = "radtan"
width_px = 320
height_px = 180
fx_px = 300.0
fy_px = 300.0
cx_px = 160.0
cy_px = 90.0
radtan = [0.0, 0.0, 0.0, 0.0, 0.0]
[mounting]
translation_m = [0.0, 0.0, 0.0]
quaternion_wxyz = [0.5, -0.5, 0.5, -0.5]
[[antenna]]
port = 1
p_C_A_m = [0.0, -0.5, 0.0]
boresight_C = [0.0, 0.0, 1.0]
lever_arm_sigma_m = 0.005
TOML
cat >/tmp/box.toml <<'TOML'
[camera]
source = "v4l2:/dev/video0"
width_px = 320
height_px = 180
frame_rate_hz = 5
stall_s = 2.0
[daemon]
calibration = "/tmp/calibration.toml"
[lcm]
url = "memq://"
TOML

echo "self-test:"
$program --self-test --config /tmp/box.toml

# Runs rfmvod until its journal has grown by so many pictures, does what else is named, and waits for as many again.
picture_bytes=$((320 * 180))
grown() {
  local bytes
  bytes=$(cat "/share/$1"/*.tmp 2>/dev/null | wc -c)
  [ "$bytes" -ge $(($2 * picture_bytes)) ]
}
await() {
  for _ in $(seq 600); do
    grown "$1" "$2" && return
    sleep 0.1
  done
  echo "$1: no $2 pictures within a minute"
}
run() {
  local name=$1 pictures=$2
  shift 2
  echo "run $name: $*"
  # shellcheck disable=SC2086
  $program --config /tmp/box.toml --journal "/share/$name" $settings 2>"/share/$name.log" &
  local pid=$!
  await "$name" "$pictures"
  [ $# -eq 0 ] || "$@"
  await "$name" $((2 * pictures))
  kill -TERM $pid
  wait $pid || echo "$name: exit code $?"
  cat "/share/$name.log"
}
for format in grey nv12 yuv420 yuyv; do
  settings="--set camera.format=$format"
  run "format-$format" 3
done
settings=""
drop() { v4l2-ctl -d /dev/video0 -c percentage_of_dropped_buffers=30; }
run drops 10 drop
v4l2-ctl -d /dev/video0 -c percentage_of_dropped_buffers=0
break_stream() { v4l2-ctl -d /dev/video0 -c inject_fatal_streaming_error=1; }
run error 5 break_stream

fail() {
  echo "camera_guest.sh: $1"
  exit 1
}
grep -q "pictures were lost on the way" /share/drops.log || fail "lost pictures were not told"
grep -q "/dev/video0: gives no picture" /share/error.log || fail "the broken stream was not told"
for name in format-grey format-nv12 format-yuv420 format-yuyv drops error; do
  ls "/share/$name"/*.lcmlog >/dev/null || fail "$name has no whole journal"
done
echo "cameras: as it should be"
