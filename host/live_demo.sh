#!/bin/bash
# The demonstration, live: a simulated reader on a TCP port and a folder of rendered frames, played at the speed at
# which they were taken, into rfmvod; everything that it publishes, and the truth beside it.
#
#   live_demo.sh BUILD-FOLDER SCENE SEED FRAMES-FOLDER OUT-FOLDER
#
# Writes OUT-FOLDER/result.lcmlog, OUT-FOLDER/truth and OUT-FOLDER/journal. FRAMES-FOLDER: of
# `rfmvo simulate --frames-to`, of the same scene and seed.
set -euo pipefail
rfmvo=$1/host/rfmvo rfmvod=$1/firmware/rfmvod scene=$2 seed=$3 frames=$4 out=$5
reader=
trap 'stop_reader' EXIT

stop_reader() {
  [ -z "$reader" ] || kill "$reader" 2>/dev/null || true
  reader=
}

# Camera and reader are in one world: both are told when the drive begins. False: not ready in time.
get_ready() {
  rm -rf "$out"
  mkdir -p "$out"
  start=$(($(date +%s) + $1))
  "$rfmvo" reader-sim --scene "$scene" --seed "$seed" --port 0 --start-at $start >"$out/reader.txt" &
  reader=$!
  "$rfmvo" simulate --scene "$scene" --seed "$seed" --start-at $start --no-frames --out "$out/poses.lcmlog" \
    --truth "$out/truth" || exit 1
  rm "$out/poses.lcmlog"
  until port=$(sed -n 's/^reader on .* port \([0-9]*\),.*/\1/p' "$out/reader.txt") && [ -n "$port" ]; do
    kill -0 $reader || exit 1
    sleep 0.1
  done
  [ "$(date +%s)" -lt $((start - 1)) ]
}

get_ready 8 || { stop_reader; get_ready 30; } || { stop_reader; get_ready 90; } || {
  echo "live_demo.sh: this machine is too busy for a live run" >&2
  exit 1
}
"$rfmvod" --config "$frames/box.toml" --journal "$out/journal" --result "$out/result.lcmlog" \
  --set camera.start_time_s=$start --set reader.address=127.0.0.1 --set reader.port="$port" \
  --set lcm.url=memq://
