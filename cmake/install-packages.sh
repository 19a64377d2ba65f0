#!/bin/bash
# Installs what cmake/packages.txt (and the command line) names and this machine lacks, and the Python
# tools of the tests under build/venv. Does nothing, and needs no network, if all of it is there.
#
#   cmake/install-packages.sh [PACKAGE...]
set -euo pipefail
cd "$(dirname "$0")/.."
venv=build/venv
requirements=cmake/requirements.txt

mapfile -t wanted < <(grep -v '^#' cmake/packages.txt; [ $# -eq 0 ] || printf '%s\n' "$@")
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null || true)
missing=()
for package in "${wanted[@]}"; do
  [[ $'\n'$installed$'\n' == *$'\n'"installed $package"$'\n'* ]] || missing+=("$package")
done

if [ ${#missing[@]} -gt 0 ]; then
  echo "installing: ${missing[*]}"
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "install-packages.sh: neither root nor sudo; please install: ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
fi

# The copy of the requirements is put there last: it says that the environment is whole.
if ! cmp -s "$requirements" "$venv/requirements.txt"; then
  echo "making $venv"
  rm -rf "$venv"
  /usr/bin/python3 -m venv "$venv"
  "$venv/bin/pip" install -q --disable-pip-version-check -r "$requirements"
  cp "$requirements" "$venv/requirements.txt"
fi
