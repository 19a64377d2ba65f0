#!/bin/bash
# Instructions per cell and term of the kernels on aarch64: what a program executes that evaluates 11 times, less what
# it executes for one time. Tool: qemu-aarch64 (qemu-user) with the plugin instruction_count.c.
#
#   instructions_per_cell.sh COUNT_CELLS PLUGIN
set -euo pipefail
instructions() {  # KERNEL TIMES
  qemu-aarch64 -L /usr/aarch64-linux-gnu -plugin "$plugin" "$program" "$1" "$2" 2>&1 >/dev/null | awk '/^instructions/ {print $2}'
}
program=$1
plugin=$2
check() {  # KERNEL LIMIT
  local cells
  cells=$(qemu-aarch64 -L /usr/aarch64-linux-gnu "$program" "$1" 1)
  awk -v name="$1" -v limit="$2" -v once="$(instructions "$1" 1)" -v often="$(instructions "$1" 11)" -v cells="$cells" '
    BEGIN {
      each = (often - once) / 10 / cells
      printf "%s: %.2f instructions per cell and term (limit %s)\n", name, each, limit
      exit !(each > 0 && each <= limit)
    }'
}
check plane 3
check spherical 8
