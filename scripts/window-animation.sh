#!/usr/bin/env bash
# Records assets/readme/window.webp, the moving picture of the window in README.md.
#
#     scripts/window-animation.sh [PROGRAM] [OUTPUT]
#
# The window runs on a screen of its own (Xvfb) and is driven by a script of its commands: the demo plays, turns and is
# scrubbed, then an aerial LiDAR tile and a recording of a depth camera. ffmpeg records the screen. Needs xvfb and ffmpeg.
set -euo pipefail

cd "$(dirname "$0")/.."
program=${1:-target/release/pointreel}
output=${2:-assets/readme/window.webp}
size=1120x700
for tool in "$program" Xvfb ffmpeg; do
    command -v "$tool" >/dev/null || {
        echo "$0: $tool is missing: expected a release build, xvfb and ffmpeg" >&2
        exit 2
    }
done

work=$(mktemp -d)
stop() {
    kill "${recorder-}" "${screen-}" 2>/dev/null || true
    rm -rf "$work"
}
trap stop EXIT
# Settings and recent files of the user are neither shown nor changed.
export XDG_CONFIG_HOME=$work XDG_CACHE_HOME=$work XDG_DATA_HOME=$work WAYLAND_DISPLAY=

Xvfb -displayfd 3 -screen 0 "${size}x24" 3>"$work/display" >/dev/null 2>&1 &
screen=$!
until [[ -s $work/display ]]; do sleep 0.1; done
display=:$(<"$work/display")
export DISPLAY=$display

{
    echo 'wait shown'
    echo 'wait 0.5'
    # Played and turning.
    echo 'Turntable'
    echo 'wait 4'
    echo 'set primitive voxel'
    echo 'wait 2'
    echo 'set primitive surfel'
    echo 'play'
    # Scrubbed, there and back.
    for frame in 2 4 6 8 10 12 10 8 6 4 2; do
        echo "frame $frame"
        echo 'wait 0.12'
    done
    echo 'open example:lidar'
    echo 'wait shown'
    echo 'wait 2.5'
    echo 'colours scalar:intensity'
    echo 'wait 2'
    echo 'open example:depth'
    echo 'wait shown'
    echo 'wait 3'
    echo 'quit'
} >"$work/tour.txt"

ffmpeg -loglevel error -f x11grab -draw_mouse 0 -framerate 10 -video_size "$size" -i "$display" \
    -c:v libx264rgb -preset ultrafast -qp 0 "$work/window.mkv" &
recorder=$!
"$program" view demo: --fullscreen --script "$work/tour.txt"
kill -INT "$recorder"
wait "$recorder" || true
# The screen is black until the window is there and after it has closed.
seconds=$(ffprobe -loglevel error -show_entries format=duration -of csv=p=0 "$work/window.mkv")
ffmpeg -loglevel error -y -ss 1.5 -t "$(awk "BEGIN { print $seconds - 2.5 }")" -i "$work/window.mkv" \
    -vf 'scale=840:-1:flags=lanczos' -c:v libwebp_anim -loop 0 -quality 45 -compression_level 6 "$output"
echo "$output: $(stat -c %s "$output") bytes"
