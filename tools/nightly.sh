#!/usr/bin/env bash
# What .ci/run has no time for: the LEGO show, all tests under the sanitizers, every fuzzer, the
# benchmarks, clang-tidy on every file. Hours on 2 cores. Writes docs/results/nightly.md.
#
#   tools/nightly.sh [FUZZ_SECONDS]           default 600 for each fuzzer
#
# PAGODA_TEST_DATA  folder of real models (default ../shared/data); required
# Exit code 1 when a part failed; the others have run all the same.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
fuzz_seconds=${1:-600}
data=$(realpath -m "${PAGODA_TEST_DATA:-../shared/data}")
[ -f "$data/stats.json" ] || { echo "nightly.sh: no models in $data" >&2; exit 1; }
mkdir -p out/nightly docs/results
rows=out/nightly/rows
: >"$rows"
failed=0

# part NAME SUMMARY_COMMAND COMMAND...: runs it, keeps its log, adds a row to the table.
part() {
    local name=$1 summary=$2 begun=$SECONDS log verdict=passed
    shift 2
    log="out/nightly/${name// /-}.log"
    echo "=== $name"
    "$@" >"$log" 2>&1 || { verdict=FAILED; failed=1; tail -20 "$log"; }
    echo "| $name | $verdict | $(((SECONDS - begun) / 60)) min | $(eval "$summary" <"$log") |" | tee -a "$rows"
}
ctest_line() { grep 'tests passed' | tail -1; }
last_line() { tail -1; }

suite() { # PRESET CTEST_OPTION...
    local preset=$1
    shift
    cmake --preset "$preset" -DPAGODA_TEST_DATA="$data" && cmake --build "build-$preset" &&
        ctest --test-dir "build-$preset" --output-on-failure -j "$(nproc)" "$@"
}

lego_show() {
    local pagoda=build-ci/tools/pagoda view
    "$pagoda" build "$data/cad/lego-show-a.glb" -o out/nightly/show.pagoda --force \
        --report out/nightly/show.json &&
        "$pagoda" verify out/nightly/show.pagoda &&
        for view in iso front top; do
            "$pagoda" render out/nightly/show.pagoda -o "out/nightly/show-$view.png" --view "$view" \
                --stats || return 1
        done &&
        "$pagoda" info out/nightly/show.pagoda --json >out/nightly/show-info.json &&
        python3 - <<'PY'
import json
report = json.load(open("out/nightly/show-info.json"))
print(f"{report['triangles']:,} triangles, {report['nodes']:,} nodes, {report['bytes']:,} bytes")
PY
}

benches() {
    local program
    for program in build-ci/tests/benchmarks/pagoda_*_benchmark; do
        [ -x "$program" ] || { echo "no benchmarks in this tree"; return 0; }
        "$program" --benchmark_repetitions=5 --benchmark_report_aggregates_only=true || return 1
    done
}

tools/install-packages.sh build test lint bench fuzz topology || exit 1
# With the models above 2M triangles, and what OpenMesh says.
every_model() {
    cmake --preset ci -DPAGODA_TESTS_OPENMESH=ON && PAGODA_NIGHTLY=1 suite ci
}
part "all tests" ctest_line every_model
part "clang-tidy, every file" last_line tools/lint.sh build-ci all
part "LEGO show" last_line lego_show
# Mesa allocates for good what it needs once; our own leaks stay visible.
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
part "address and undefined-behaviour sanitizers" ctest_line suite asan --timeout 1800
# Mesa's threads are not instrumented, so that every lock of theirs would look like a race.
export TSAN_OPTIONS=halt_on_error=1
tsan() { cmake --preset tsan -DPAGODA_VIEWER=OFF && suite tsan --timeout 1800; }
part "thread sanitizer, without viewer" ctest_line tsan
part "fuzzers, $fuzz_seconds s each" 'awk "NR > 1 && /[0-9]/ { printf \"%s %s (%s); \", \$1, \$2, \$4 }"' \
    bash -c "tools/fuzz.sh $fuzz_seconds | grep -E '^(target|ply|obj|stl|off|gltf|drc|page|mesh|database) '"
part "benchmarks" last_line benches

{
    echo "# Nightly run"
    echo
    echo "By \`tools/nightly.sh $fuzz_seconds\` at $(git rev-parse --short HEAD)," \
        "$(nproc) cores, $(c++ --version | head -1)."
    echo "Fuzzers: executions and findings of each target."
    echo
    echo "| part | verdict | time | summary |"
    echo "|---|---|---|---|"
    cat "$rows"
} >docs/results/nightly.md
echo "docs/results/nightly.md"
exit $failed
