#!/usr/bin/env bash
# Licences, banned crates and sources of everything that is built, and known vulnerabilities where their list can be had.
# Needs cargo-deny, which is built into the target folder where it is not at hand.
set -euo pipefail
cd "$(dirname "$0")/.."

tools=${CARGO_TARGET_DIR:-target}/tools
if ! PATH="$tools/bin:$PATH" command -v cargo-deny > /dev/null; then
  cargo install cargo-deny --locked --debug --quiet --root "$tools"
fi
deny() { PATH="$tools/bin:$PATH" cargo-deny --log-level error "$@"; }

deny check bans licenses sources
if deny fetch db 2> /dev/null; then
  deny check --disable-fetch advisories
else
  echo "known vulnerabilities are not looked for: their list cannot be reached from here"
fi
