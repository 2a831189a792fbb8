#!/usr/bin/env bash
# Fuzzes for a bounded time, in rounds: each target of cargo-fuzz for a while, then mutations with right checksums of all
# sets through the verbs and the window (tests/mutations) for as long as all targets together.
#
#     scripts/fuzz.sh [SECONDS] [FOLDER_OF_SEED_FILES…]
#
# SECONDS is for everything, after it is built (default: 600); SLICE_S is what a target has in a round (default: 30, less
# where a round would not fit). Seeds are the project's own fixtures and the files in the folders given. Findings are
# kept in fuzz/artifacts and fuzz/found, and the last lines are a table: executions, coverage (edges), new findings. The
# exit code is 1 if there are any.
#
# Needs cargo-fuzz, which it installs, and a C++ compiler. Sanitizers are a matter of nightly compilers; RUSTC_BOOTSTRAP
# lets the stable one do it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-600}
shift || true
# SQLite and another C library have a table of the same name each.
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_odr_violation=0}

cargo_fuzz() { RUSTC_BOOTSTRAP=1 cargo fuzz "$@"; }
cargo_fuzz --version >/dev/null 2>&1 || RUSTC_BOOTSTRAP=1 cargo install --locked --quiet cargo-fuzz

# The extensions in the order of `Format`'s table: the first byte of a seed chooses among them.
extensions=(ply pcd las laz e57 drc xyz txt csv asc pts ptx obj off stl gltf glb npy npz bin mcap bag db3 pcap pcapng zip tar tgz gz)
lists=(zip tar tgz mcap bag db3 e57 glb)
cameras=(bag mcap db3)
mkdir -p fuzz/corpus/read fuzz/corpus/list fuzz/corpus/cameras fuzz/corpus/reel fuzz/corpus/packets \
    fuzz/corpus/photos fuzz/corpus/matroska fuzz/corpus/wire
cp src/reel/tests/*.reel fuzz/corpus/reel/
# Written by hand: the smallest files of each format that have everything.
cp fuzz/seeds/photos/* fuzz/corpus/photos/
cp fuzz/seeds/matroska/* fuzz/corpus/matroska/
printf "$(tr -d '[:space:]' <src/wire/test_vector.txt | sed 's/../\\x&/g')" >fuzz/corpus/wire/test_vector

# seed TARGET PLACE FILE: a seed that chooses the extension at PLACE.
seed() {
    local name
    name=$(sha256sum "$3" | cut -c1-16)
    { printf "\\x$(printf %02x "$2")"; cat "$3"; } >"fuzz/corpus/$1/$name"
}
place_of() { # place_of EXTENSION LIST…: where it stands, or nothing
    local wanted=$1 place=0
    shift
    for extension in "$@"; do
        [[ $extension == "$wanted" ]] && { echo "$place"; return; }
        place=$((place + 1))
    done
}
while IFS= read -r -d '' file; do
    extension=${file##*.}
    extension=${extension,,}
    place=$(place_of "$extension" "${extensions[@]}")
    [[ -n $place ]] && seed read "$place" "$file"
    place=$(place_of "$extension" "${lists[@]}")
    [[ -n $place ]] && seed list "$place" "$file"
    place=$(place_of "$extension" "${cameras[@]}")
    [[ -n $place ]] && seed cameras "$place" "$file"
# Large files make slow seeds; what is in them is in small ones too.
done < <(find tests/data fuzz/seeds/mutations "$@" -type f -size -64k -print0)

targets=(read list cameras reel packets photos matroska wire)
declare -A executions spent_s edges found
for target in "${targets[@]}"; do
    executions[$target]=0 spent_s[$target]=0 edges[$target]=- found[$target]=0
done
most_slice_s=$((seconds / (2 * ${#targets[@]})))
slice_s=${SLICE_S:-30}
((slice_s <= most_slice_s)) || slice_s=$((most_slice_s > 0 ? most_slice_s : 1))

artifacts() {
    mkdir -p "fuzz/artifacts/$1"
    find "fuzz/artifacts/$1" -type f | wc -l
}

# One slice of a target of cargo-fuzz. A finding ends it early; the next one goes on with the corpus as it is then.
run_target() {
    local target=$1 before log
    before=$(artifacts "$target")
    log=$(mktemp)
    cargo_fuzz run "$target" -- -max_total_time="$slice_s" -timeout=20 -rss_limit_mb=4096 -max_len=65536 \
        -print_final_stats=1 >"$log" 2>&1 || true
    local count cov
    count=$(awk '/stat::number_of_executed_units/ { print $2 }' "$log" | tail -n 1)
    cov=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -d ' ' -f 2 || true)
    if [[ -z $count && -z $cov ]]; then
        echo "$target did not run:" >&2
        tail -n 20 "$log" >&2
        exit 1
    fi
    executions[$target]=$((executions[$target] + ${count:-0}))
    spent_s[$target]=$((spent_s[$target] + slice_s))
    edges[$target]=${cov:-${edges[$target]}}
    found[$target]=$((found[$target] + $(artifacts "$target") - before))
    rm "$log"
}

# Mutations of all sets; adds up what each line of its table says.
mutated=()
run_mutations() {
    local spent=$((slice_s * ${#targets[@]})) set cases count rate ms mb all new
    MUTATIONS_SECONDS=$spent MUTATIONS_SEEDS=$(IFS=:; echo "$*") \
        cargo test --quiet --locked --test mutations -- --ignored --exact rounds --nocapture
    while read -r set cases count rate ms mb all new; do
        [[ -n $set ]] || continue
        [[ -n ${executions[$set-mutated]:-} ]] || mutated+=("$set-mutated")
        executions[$set-mutated]=$((${executions[$set-mutated]:-0} + count))
        spent_s[$set-mutated]=$((${spent_s[$set-mutated]:-0} + spent))
        edges[$set-mutated]=-
        found[$set-mutated]=$((${found[$set-mutated]:-0} + new))
    done < <(sed '1,/^set /d' fuzz/found/table.txt)
}

# Building is not fuzzing.
cargo_fuzz build
cargo test --quiet --locked --test mutations --no-run
end_s=$((SECONDS + seconds))
while ((SECONDS < end_s)); do
    for target in "${targets[@]}"; do
        run_target "$target"
    done
    run_mutations "$@"
done

all_found=0
printf '\n%-24s%14s%10s%10s%14s\n' set executions 'per s' edges 'new findings'
for name in "${targets[@]}" "${mutated[@]}"; do
    printf '%-24s%14d%10d%10s%14d\n' "$name" "${executions[$name]}" \
        $((executions[$name] / (spent_s[$name] > 0 ? spent_s[$name] : 1))) "${edges[$name]}" "${found[$name]}"
    all_found=$((all_found + found[$name]))
done
if ((all_found > 0)); then
    echo "$all_found findings are in fuzz/artifacts and fuzz/found" >&2
    exit 1
fi
