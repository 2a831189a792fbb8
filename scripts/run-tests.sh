#!/usr/bin/env bash
# Runs all tests but those of the docs, two test programs at a time.
#
# One program alone leaves a processor idle wherever its tests wait for another program, a clock or a lock, and at its
# end; `cargo test` runs one after the other. What a program says is shown when it has ended.
set -euo pipefail
cd "$(dirname "$0")/.."
me=$PWD/scripts/run-tests.sh
export CARGO="${CARGO:-cargo}"

# The longest first, so that none is left at the end.
longest_first=(lib pictures files program panels bench_suites)
# These need the machine for themselves: real windows, whose pictures are to come to rest.
alone=(session window)

all=(lib)
for file in tests/*.rs tests/*/main.rs; do
    name=${file#tests/}
    name=${name%/main.rs}
    all+=("${name%.rs}")
done
others=$(printf '%s\n' "${all[@]}" | grep -vxF -f <(printf '%s\n' "${longest_first[@]}" "${alone[@]}"))

run_one() {
    local name=$1 said failed=0
    said=$(mktemp)
    if [[ $name == lib ]]; then
        "$CARGO" test --locked --lib >"$said" 2>&1 || failed=1
    else
        "$CARGO" test --locked --test "$name" >"$said" 2>&1 || failed=1
    fi
    flock "$me" cat "$said"
    rm "$said"
    return $failed
}
if [[ ${1-} == --one ]]; then
    run_one "$2"
    exit
fi

"$CARGO" test --locked --lib --tests --no-run
printf '%s\n' "${longest_first[@]}" $others | xargs -P 2 -I '{}' "$me" --one '{}'
for name in "${alone[@]}"; do
    run_one "$name"
done
