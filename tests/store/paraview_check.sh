#!/bin/sh
# paraview_check.sh MAKE_RUN: writes a small run and lets ParaView read it. Exit code 77 (skipped) without ParaView.
if ! command -v pvpython >/dev/null; then
    echo "skipped: pvpython is missing (Debian: apt-get install paraview python3-paraview)"
    exit 77
fi
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
"$1" "$folder/written" || exit 1
mv "$folder/written" "$folder/run" # links inside a run must survive its being moved
cd / && pvpython --force-offscreen-rendering "$(dirname "$0")/paraview_check.py" "$folder/run"
