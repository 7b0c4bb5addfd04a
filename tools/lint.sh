#!/usr/bin/env bash
# clang-tidy on the source files that changed.
#
#   tools/lint.sh BUILD_FOLDER [BASE]   BASE: a commit; default where this branch left origin/main,
#                                       else the commit before; "all": every source file
#
# PAGODA_LINT_SECONDS  stops after so long and names what was not looked at (default 120; "all" has
#                      no limit)
set -euo pipefail
cd "$(dirname "$0")/.."
build=$1
base=${2:-}

if [ -z "$base" ]; then
    base=$(git merge-base HEAD origin/main 2>/dev/null || true)
    [ -n "$base" ] && [ "$base" != "$(git rev-parse HEAD)" ] || base=HEAD~1
fi
if [ "$base" = all ]; then
    mapfile -t files < <(git ls-files '*.cpp')
    limit=86400
else
    mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- '*.cpp')
    limit=${PAGODA_LINT_SECONDS:-120}
fi

# Only what this build compiles: without its flags clang-tidy would guess.
known=()
for file in "${files[@]}"; do
    grep -qF "/$file\"" "$build/compile_commands.json" && known+=("$file")
done
if [ ${#known[@]} -eq 0 ]; then
    echo "no source file of this build changed since $base"
    exit 0
fi

# Every process notes its verdict, so that what the clock left out can be named.
verdicts=$(mktemp)
commands=$(mktemp -d) # without precompiled headers, which are g++'s
trap 'rm -rf "$verdicts" "$commands"' EXIT
sed 's/ -Winvalid-pch//; s/ -include [^ ]*cmake_pch\.hxx//' "$build/compile_commands.json" \
    >"$commands/compile_commands.json"
export commands verdicts
printf '%s\n' "${known[@]}" | timeout "$limit" xargs -P "$(nproc)" -I{} bash -c '
    if clang-tidy -p "$commands" --quiet "$1" 2>/dev/null; then verdict=ok; else verdict=bad; fi
    echo "$verdict $1" >>"$verdicts"' _ {} || true

bad=$(grep -c '^bad ' "$verdicts" || true)
looked_at=$(wc -l <"$verdicts")
if [ "$looked_at" -lt ${#known[@]} ]; then
    echo "clang-tidy: out of time after $limit s; not looked at (tools/nightly.sh looks at all):"
    printf '%s\n' "${known[@]}" | grep -vxFf <(cut -d' ' -f2- "$verdicts") || true
fi
echo "clang-tidy: $looked_at of ${#known[@]} files changed since $base, $bad with findings"
[ "$bad" -eq 0 ]
