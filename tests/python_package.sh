#!/usr/bin/env bash
# The Python package: its tests on the oldest and the newest CPython that the machine has, without and with the packages
# that it can use; its notebooks; its types.
# Needs Python 3.9 or newer; the rest is installed into the target folder. Takes the program at ARCSLIP_PROGRAM, or builds
# one.
set -euo pipefail
cd "$(dirname "$0")/.."

target=${CARGO_TARGET_DIR:-target}
if [ -z "${ARCSLIP_PROGRAM:-}" ]; then
  cargo build --release --quiet
  ARCSLIP_PROGRAM=$(realpath "$target/release/arcslip")
fi
export ARCSLIP_PROGRAM MPLBACKEND=Agg

# Every CPython by its version, of the search path and of pyenv.
interpreters() {
  for python in $(compgen -c python3 | grep -E '^python3(\.[0-9]+)?$' | sort -u) "${PYENV_ROOT:-$HOME/.pyenv}"/versions/*/bin/python3; do
    "$python" -c '
import sys
if sys.version_info >= (3, 9) and sys.implementation.name == "cpython":
    print("%d.%02d" % sys.version_info[:2], sys.executable)' 2> /dev/null || true
  done | sort -u -k 1,1
}

run() {
  local version=$1 python=$2 tools
  tools=$target/tools/python_package/$version
  if ! [ -x "$tools/bin/python" ]; then
    "$python" -m venv "$tools" 2> /dev/null ||
      { apt-get update -q && apt-get install -qy python3-venv && "$python" -m venv "$tools"; }
  fi
  echo "Python ${version/.0/.}, nothing else installed"
  "$python" -m venv --clear --without-pip "$tools/plain"
  PYTHONPATH=openapi/python/src "$tools/plain/bin/python" -m unittest discover -s openapi/python/tests \
    2> "$tools/plain.log" || { cat "$tools/plain.log"; exit 1; }
  tail -1 "$tools/plain.log"
  "$tools/bin/pip" install -q --force-reinstall --no-deps ./openapi/python
  "$tools/bin/pip" install -q './openapi/python[all]' nbclient ipykernel
  echo "Python ${version/.0/.}, with what it can use"
  "$tools/bin/python" -m unittest discover -s openapi/python/tests 2> "$tools/all.log" || { cat "$tools/all.log"; exit 1; }
  tail -1 "$tools/all.log"
  "$tools/bin/python" -m doctest openapi/python/src/arcslip/__init__.py
}

found=$(interpreters)
test -n "$found" || { echo "there is no CPython 3.9 or newer"; exit 1; }
oldest=$(head -1 <<< "$found") newest=$(tail -1 <<< "$found")
# shellcheck disable=SC2086
run $oldest
# shellcheck disable=SC2086
if [ "$newest" != "$oldest" ]; then run $newest; fi
tools=$target/tools/python_package/${newest%% *}
# A notebook shows its pictures by a backend of its own.
env -u MPLBACKEND "$tools/bin/python" openapi/python/tests/run_notebooks.py "$@" 2> "$tools/notebooks.log" ||
  { cat "$tools/notebooks.log"; exit 1; }
"$tools/bin/pip" install -q mypy
"$tools/bin/python" -m mypy --strict --no-warn-return-any --ignore-missing-imports -p arcslip
