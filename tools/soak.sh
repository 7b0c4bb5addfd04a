#!/usr/bin/env bash
# Runs many frames of random cameras, strategies, budgets, latencies, disks (slow, failing) and
# prefetch on the software device and a virtual clock, a process a core, each with a seed of its
# own; after each frame budgets hold, nothing visible is left out, counts agree. Then some on GL.
#
#   tools/soak.sh [FRAMES [SEED [GL_FRAMES]]]     default 100000 frames (about 3 minutes of CPU
#                                                 time) and 2000 on GL; the seeds are printed
#
# PAGODA_SOAK  the program (default: built here, build-release/tests/soak/pagoda_soak)
# Exit code 1 when a rule is broken: the first of them are listed; the same seed gives them again.
set -euo pipefail
cd "$(dirname "$0")/.."

frames=${1:-100000} seed=${2:-$RANDOM} gl_frames=${3:-2000}
soak=${PAGODA_SOAK:-build-release/tests/soak/pagoda_soak}
if [ -z "${PAGODA_SOAK:-}" ]; then
    tools/install-packages.sh build test
    cmake --preset release >/dev/null
    cmake --build build-release --target pagoda_soak >/dev/null
fi

processes=$(nproc)
share=$(((frames + processes - 1) / processes))
running=()
# Processes in the background do not hear Ctrl-C.
trap 'kill "${running[@]}" 2>/dev/null || true' EXIT INT TERM
for ((i = 0; i < processes; ++i)); do
    "$soak" "$share" "$((seed + i))" &
    running+=($!)
done
failed=0
for process in "${running[@]}"; do wait "$process" || failed=1; done
[ "$gl_frames" -eq 0 ] || "$soak" --gl "$gl_frames" "$seed" || failed=1
exit $failed
