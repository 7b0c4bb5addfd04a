#!/usr/bin/env bash
# Runs many frames of random cameras, strategies, budgets, latencies and disks (slow, failing) on
# the software device and a virtual clock; after each frame budgets hold, nothing visible is left
# out, counts agree.
#
#   tools/soak.sh [FRAMES [SEED]]       default 100000 frames (about ten minutes of one core); the
#                                       seed is printed
#
# PAGODA_SOAK  the program (default: built here, build-release/tests/soak/pagoda_soak)
# Exit code 1 when a rule is broken: the first of them are listed; the same seed gives them again.
set -euo pipefail
cd "$(dirname "$0")/.."

soak=${PAGODA_SOAK:-build-release/tests/soak/pagoda_soak}
if [ -z "${PAGODA_SOAK:-}" ]; then
    tools/install-packages.sh build test
    cmake --preset release >/dev/null
    cmake --build build-release --target pagoda_soak >/dev/null
fi
exec "$soak" "${1:-100000}" ${2:+"$2"}
