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
rm -rf "$out"
mkdir -p "$out"

# Camera and reader are in one world: both know when the drive begins. The reader takes a second to make its tags.
start=$(($(date +%s) + 10))
"$rfmvo" reader-sim --scene "$scene" --seed "$seed" --port 0 --start-at $start >"$out/reader.txt" &
reader=$!
trap 'kill $reader 2>/dev/null || true' EXIT
"$rfmvo" simulate --scene "$scene" --seed "$seed" --start-at $start --no-frames --out "$out/poses.lcmlog" \
  --truth "$out/truth"
rm "$out/poses.lcmlog"
until port=$(sed -n 's/^reader on .* port \([0-9]*\),.*/\1/p' "$out/reader.txt") && [ -n "$port" ]; do
  kill -0 $reader
  sleep 0.1
done
if [ "$(date +%s)" -ge $start ]; then
  echo "live_demo.sh: this machine was too busy to be ready in time" >&2
  exit 1
fi
"$rfmvod" --config "$frames/box.toml" --journal "$out/journal" --result "$out/result.lcmlog" \
  --set camera.start_time_s=$start --set reader.address=127.0.0.1 --set reader.port="$port" \
  --set lcm.url=memq://
