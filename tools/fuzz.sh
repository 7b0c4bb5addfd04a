#!/usr/bin/env bash
# Runs fuzzers side by side and reports executions and findings.
#
#   tools/fuzz.sh SECONDS [TARGET...]         default: every target, each for SECONDS
#
# As many at once as there are cores; the rest wait their turn, so all of them take
# SECONDS x ceil(targets / cores). Findings are kept in build-fuzz/findings/TARGET/; to keep one for
# good, mend it and copy it to tests/fuzz/corpus/regressions/TARGET/.
# PAGODA_FUZZ_JOBS  how many at once (default: cores)
# Exit code 1 when there is a finding.
set -euo pipefail
cd "$(dirname "$0")/.."

all=(ply obj stl off gltf drc page mesh database)
seconds=${1:?usage: tools/fuzz.sh SECONDS [TARGET...]}
shift
[ $# -gt 0 ] || set -- "${all[@]}"

tools/install-packages.sh build fuzz
cmake --preset fuzz >/dev/null
cmake --build build-fuzz --target pagoda_fuzz

fuzz_one() {
    target=$1
    here=build-fuzz/findings/$target
    mkdir -p "$here" "build-fuzz/grown/$target"
    regressions=tests/fuzz/corpus/regressions/$target
    [ -d "$regressions" ] || regressions=
    # The first folder takes what is found new; 512 MiB and 25 s an input are far above any sound
    # run. Leaks count too.
    # shellcheck disable=SC2086
    PAGODA_FUZZ_TARGET=$target ./build-fuzz/tests/fuzz/pagoda_fuzz \
        -max_total_time="$seconds" -timeout=25 -rss_limit_mb=1024 -malloc_limit_mb=512 \
        -max_len=65536 -print_final_stats=1 -artifact_prefix="$here/" \
        "build-fuzz/grown/$target" "tests/fuzz/corpus/$target" $regressions \
        >"$here/log" 2>&1 || true
}
export -f fuzz_one
export seconds
rm -rf build-fuzz/findings
printf '%s\n' "$@" | xargs -P "${PAGODA_FUZZ_JOBS:-$(nproc)}" -I{} bash -c 'fuzz_one {}'

failed=0
printf '%-10s %12s %10s  %s\n' target executions covered findings
for target in "$@"; do
    log=build-fuzz/findings/$target/log
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1)
    covered=$(grep -o ' cov: [0-9]*' "$log" | tail -1 | tr -dc 0-9 || true)
    findings=$(find "build-fuzz/findings/$target" -type f ! -name log -printf '%f ')
    [ -n "$executions" ] || findings="did not run: $(tail -1 "$log")"
    [ -z "$findings" ] || failed=1
    printf '%-10s %12s %10s  %s\n' "$target" "${executions:-?}" "${covered:-?}" "${findings:-none}"
done
exit $failed
