#!/usr/bin/env bash
# Fuzzes the readers for a bounded time.
#
#     scripts/fuzz.sh [SECONDS_A_TARGET] [FOLDER_OF_SEED_FILES…]
#
# Seeds are the project's own fixtures and the files in the folders given; what is found is kept in fuzz/corpus and
# fuzz/artifacts. Needs cargo-fuzz, which it installs, and a C++ compiler. Sanitizers are a matter of nightly compilers;
# RUSTC_BOOTSTRAP lets the stable one do it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
shift || true
export RUSTC_BOOTSTRAP=1
# SQLite and another C library have a table of the same name each.
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_odr_violation=0}

cargo fuzz --version >/dev/null 2>&1 || cargo install --locked --quiet cargo-fuzz

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
done < <(find tests/data "$@" -type f -size -64k -print0)

for target in read list cameras reel packets photos matroska wire; do
    cargo fuzz run "$target" -- -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=65536
done
