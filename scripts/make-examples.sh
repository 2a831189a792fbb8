#!/bin/sh
# Makes assets/examples from data of others: see assets/examples/README.md for whose it is.
#
#   scripts/make-examples.sh POINTREEL LASPY_DATA OPENCV_DATA FOX
#
# POINTREEL is the program, LASPY_DATA the folder with autzen_trim.laz, OPENCV_DATA that with aloeL.jpg and aloeGT.png,
# FOX the file Fox.gltf. The depth image needs Python with numpy and Pillow.
set -eu

if [ $# -ne 4 ]; then
    sed -n '2,7p' "$0" >&2
    exit 2
fi
pointreel=$1 laspy=$2 opencv=$3 fox=$4
here=$(dirname "$0")
out=$here/../assets/examples
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$pointreel" convert "$laspy/autzen_trim.laz" "$scratch/lidar.reel" --bits 10 --color-error 6
python3 "$here/depth_example.py" "$opencv" "$scratch/aloe.pcd"
"$pointreel" convert "$scratch/aloe.pcd" "$scratch/depth.reel" --bits 9 --color-error 6
"$pointreel" convert "$fox" "$scratch/model.reel" --sample 7000 --precision 0.3 --color-error 8 --keep-order \
    --keyframes 28
for name in lidar depth model; do
    cp "$scratch/$name.reel" "$out/$name.reel"
    "$pointreel" render "$out/$name.reel" -o "$scratch/$name.png" --size 280x210 --renderer cpu \
        --antialiasing supersample
    python3 - "$scratch/$name.png" "$out/$name.png" <<'PY'
import sys
from PIL import Image

Image.open(sys.argv[1]).convert("RGB").quantize(96).save(sys.argv[2], optimize=True)
PY
done
ls -l "$out"
