#!/usr/bin/env bash
# The files of results read by the programs they are for: VTK's reader, and pyarrow.
# Needs Python; both are installed into the target folder. Takes the program at ARCSLIP_PROGRAM, or builds one.
set -euo pipefail
cd "$(dirname "$0")/.."

target=${CARGO_TARGET_DIR:-target}
tools=$target/tools/result_files
if ! [ -x "$tools/bin/python" ]; then
  python3 -m venv "$tools" 2> /dev/null ||
    { apt-get update -q && apt-get install -qy python3-venv && python3 -m venv "$tools"; }
fi
# VTK's reader of XML files needs no display, but the libraries of one.
"$tools/bin/python" -c 'import pyarrow, vtk' 2> /dev/null || "$tools/bin/pip" install -q 'numpy>=2' 'pyarrow>=20' 'vtk>=9.4,<10'
if [ -z "${ARCSLIP_PROGRAM:-}" ]; then
  cargo build --release --quiet
  ARCSLIP_PROGRAM=$(realpath "$target/release/arcslip")
fi
"$tools/bin/python" tests/result_files.py --program "$ARCSLIP_PROGRAM" "$@"
