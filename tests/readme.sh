#!/usr/bin/env bash
# Runs the README's commands as they stand there and compares the pasted output with what comes now.
# Needs curl; uses port 8080 and a folder of its own for what the commands write.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v curl > /dev/null || { apt-get update -q && apt-get install -qy curl; }

work=$(mktemp -d)
# Nothing that was started goes on, and nothing that was written stays.
postgres=
leave() {
  { [ -z "$postgres" ] || kill -QUIT "$postgres"; kill %1; wait; } 2> /dev/null || true
  rm -rf "$work"
  rm -f path.ndjson path.svg path.csv *-study.svg study.csv *-sweep.svg sweep.csv arcslip.db arcslip.db-*
}
trap leave EXIT

# The fenced blocks of the README in order: language on the first line of each file.
awk -v folder="$work" '/^```/ { if (inside) { inside = 0; close(file) } else { inside = 1; count++;
    file = sprintf("%s/block%02d", folder, count); sub(/^```/, ""); print > file }; next }
  inside { print > file }' README.md

block() { grep -l "$1" "$work"/block* | head -1; }
run() { tail -n +2 "$1" > "$work/script.sh"; bash -euo pipefail "$work/script.sh"; }

serve=$(block 'serve --demo')
grep -q '^cargo run --release -- serve --demo$' "$serve"
cargo build --release
if curl -sf http://127.0.0.1:8080/healthz > /dev/null; then echo "port 8080 is taken"; exit 1; fi
bash -c "exec $(tail -n +2 "$serve")" > "$work/serve.log" 2>&1 &
for _ in $(seq 1 100); do
  if curl -sf http://127.0.0.1:8080/readyz > /dev/null; then break; fi
  sleep 0.2
done
curl -sf http://127.0.0.1:8080/readyz > /dev/null || { cat "$work/serve.log"; exit 1; }

# One shell for both, as a reader has it: the second goes on with the first one's job.
{ tail -n +2 "$(block '/v1/scenes/klarbring')"; tail -n +2 "$(block '/follow -H')"; } > "$work/both.sh"
bash -euo pipefail "$work/both.sh" | tee "$work/corners"
{ tail -n +2 "$(block '^{"index":3,')"; tail -n +2 "$(block '^{"index":0,')"; } | diff - "$work/corners"

# Jobs that end as stopped leave exit status 1: the one-bar truss ends in its mechanism.
while read -r command; do
  status=0
  bash -c "$command" > "$work/out" 2> "$work/err" || status=$?
  case "$status:$command" in
    0:* | 1:*one-bar-truss*) ;;
    *) cat "$work/out" "$work/err"; echo "failed ($status): $command"; exit 1 ;;
  esac
done < <(tail -n +2 "$(block 'solve one-bar-truss --out')")
test -s path.ndjson && test -s path.svg && test -s path.csv

# The studies' tables and pictures are made.
while read -r command; do
  bash -c "$command" > "$work/out" 2> "$work/err" || { cat "$work/out" "$work/err"; echo "failed: $command"; exit 1; }
done < <(tail -n +2 "$(block 'study one-bar-truss')")
test -s one-bar-truss-study.svg && test -s capstan-study.svg && test -s study.csv

# The sweeps' table and picture are made, and the picture is the one shown.
while read -r command; do
  bash -c "$command" > "$work/out" 2> "$work/err" || { cat "$work/out" "$work/err"; echo "failed: $command"; exit 1; }
done < <(tail -n +2 "$(block 'sweep arch-type-truss')")
cmp arch-type-truss-sweep.svg src/check/scenes/pictures/arch-type-truss-sweep.svg
test "$(wc -l < sweep.csv)" = 7

# The model in the README is one.
tail -n +2 "$(block '"dimension": 2')" > "$work/model.json"
target=${CARGO_TARGET_DIR:-target}
"$target/release/arcslip" check "$work/model.json" > /dev/null
"$target/release/arcslip" solve "$work/model.json" > /dev/null

# The pictures are what the program draws.
for scene in one-bar-truss three-snapping-bars; do
  "$target/release/arcslip" solve "$scene" --out /dev/null --plot "$work/$scene.svg" 2> /dev/null || test $? = 1
  cmp "$work/$scene.svg" "src/check/scenes/pictures/$scene.svg"
done
# A server and two workers on PostgreSQL: one of a folder of its own takes the place of the one that the commands mean.
binaries=$(ls -d /usr/lib/postgresql/*/bin 2> /dev/null | sort -V | tail -1)
if [ -z "$binaries" ]; then
  [ "${ARCSLIP_POSTGRES:-}" != required ] || { echo "PostgreSQL is required and not there"; exit 1; }
  echo "skipped: no PostgreSQL; the README's section on many machines is not shown"
else
  as=(); if [ "$(id -u)" = 0 ]; then as=(setpriv --reuid postgres --regid postgres --clear-groups); fi
  mkdir -m 777 "$work/postgres"; chmod 755 "$work"
  export PGHOST=localhost PGPORT=54329 PGUSER=administrator PATH="$(cd "$target/release" && pwd):$binaries:$PATH"
  "${as[@]}" "$binaries/initdb" --auth=trust --username="$PGUSER" --no-sync -D "$work/postgres/data" > "$work/initdb.log"
  "${as[@]}" "$binaries/postgres" -D "$work/postgres/data" -p "$PGPORT" -k "$work/postgres" > "$work/postgres.log" 2>&1 &
  postgres=$!
  for _ in $(seq 1 100); do if "$binaries/pg_isready" -q; then break; fi; sleep 0.1; done
  # What it leaves at work ends with the shell that began it, in good order.
  { tail -n +2 "$(block 'createuser arcslip')"; echo 'kill $(jobs -p); wait'; } > "$work/script.sh"
  (cd "$work" && bash -euo pipefail script.sh) > "$work/hosts" 2> "$work/hosts.log" ||
    { cat "$work/hosts" "$work/hosts.log"; exit 1; }
  grep -q '"status":"ready","workers":0' "$work/hosts"
  test "$(tail -1 "$work/hosts")" = "$(arcslip solve klarbring 2> /dev/null | grep -c index)"
  kill -INT $postgres; wait $postgres
fi

# A clean shutdown.
kill -TERM %1
wait %1
echo "the README's commands do what it says"
