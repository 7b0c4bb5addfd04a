#!/usr/bin/env bash
# Installs what is missing, builds Pagoda and runs every test. Ends with ctest's summary.
#
#   tools/test.sh [CTEST OPTIONS]             e.g. tools/test.sh -R '^ooc: '
#
# PAGODA_TEST_DATA  folder of real models (default ../shared/data); tests that need it are skipped
#                   without it
# PAGODA_PRESET     CMake preset (default release)
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${PAGODA_PRESET:-release}
data=${PAGODA_TEST_DATA:-../shared/data}
groups=(build test)
[ "$preset" != ci ] || groups+=(bench)

tools/install-packages.sh "${groups[@]}"
say_missing_data() {
    [ ! -d "$data" ] || return 0
    printf '\n*** No models in PAGODA_TEST_DATA=%s: every test on real models is SKIPPED. ***\n\n' \
        "$data" >&2
}
say_missing_data
cmake --preset "$preset" -DPAGODA_TEST_DATA="$(realpath -m "$data")"
cmake --build "build-$preset"
say_missing_data
ctest --test-dir "build-$preset" --output-on-failure -j "$(nproc)" "$@"
