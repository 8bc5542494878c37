#!/usr/bin/env bash
# The live server against its own description: every call with what the description allows and with what it does not, twice:
# as it is on its own machine, and where it asks for tokens. SEED and EXAMPLES can be set.
# Needs Python; Schemathesis is installed into the target folder. Takes the program at ARCSLIP_PROGRAM, or builds one.
set -euo pipefail
cd "$(dirname "$0")/.."

target=${CARGO_TARGET_DIR:-target}
tools=$target/tools/schemathesis
if ! [ -x "$tools/bin/st" ]; then
  python3 -m venv "$tools" 2> /dev/null ||
    { apt-get update -q && apt-get install -qy python3-venv && python3 -m venv "$tools"; }
  "$tools/bin/pip" install -q 'schemathesis>=4.32,<5'
fi
if [ -z "${ARCSLIP_PROGRAM:-}" ]; then
  cargo build --release --quiet
  ARCSLIP_PROGRAM=$(realpath "$target/release/arcslip")
fi

work=$(mktemp -d)
server=
trap 'kill $server 2> /dev/null || true; rm -rf "$work"' EXIT

serve() {
  "$ARCSLIP_PROGRAM" serve --listen 127.0.0.1:0 --database "$work/$1.db" "${@:2}" > "$work/$1.out" 2> "$work/$1.log" &
  server=$!
  for _ in $(seq 1 100); do
    url=$(sed -n 's/.* listens on //p' "$work/$1.out")
    if [ -n "$url" ]; then return; fi
    sleep 0.1
  done
  cat "$work/$1.log"
  exit 1
}
ask() {
  "$tools/bin/st" --config-file tests/schemathesis/schemathesis.toml run "$url/openapi.json" --checks all \
    --seed "${SEED:-1}" --max-examples "${EXAMPLES:-20}" --generation-database none --no-color "$@"
}
# Nothing that was asked may have been a defect of the service.
quiet() {
  kill "$server"
  wait "$server"
  if grep -E ' (ERROR|WARN) ' "$work/$1.log"; then echo "the log has more to say than it should"; exit 1; fi
}

serve open
ask
quiet open

token=$("$ARCSLIP_PROGRAM" token all --scopes admin 2>&1 > "$work/tokens")
serve tokens --tokens-file "$work/tokens"
ask -H "Authorization: Bearer $token"
quiet tokens
echo "the service is as it describes itself"
