#!/usr/bin/env bash
# Draws the same pictures with two builds of pointreel and compares them byte by byte.
#
#     tests/same_pictures.sh OLD NEW [DATA]
#
# OLD and NEW are the programs, DATA is a folder of real files (usually ../shared/data beside the checkout; what is not
# there is skipped). It is for changes that are to change no picture: pictures of one machine are compared, so nothing is
# allowed to differ, and nothing is stored. What `--lod-time` draws depends on the machine's pace, so it is left out. The
# GPU renderer runs on lavapipe (mesa-vulkan-drivers). The status is 1 if a picture differs or was not drawn.
set -euo pipefail

if (($# < 2 || $# > 3)); then
    echo "usage: $0 OLD NEW [DATA]" >&2
    exit 2
fi
old=$(command -v "$1") || { echo "$0: there is no program $1" >&2; exit 2; }
new=$(command -v "$2") || { echo "$0: there is no program $2" >&2; exit 2; }
data=${3:-$(dirname "$0")/../../shared/data}

if [[ -z ${VK_DRIVER_FILES-}${VK_ICD_FILENAMES-} ]]; then
    lavapipe=$(compgen -G '/usr/share/vulkan/icd.d/lvp_icd*.json' | head -n 1) || {
        echo "$0: there is no lavapipe: install mesa-vulkan-drivers" >&2
        exit 2
    }
    export VK_DRIVER_FILES=$lavapipe VK_ICD_FILENAMES=$lavapipe
fi

work=$(mktemp -d)
mkdir "$work/old" "$work/new"
# What a person has kept is neither read nor written.
export XDG_CONFIG_HOME=$work/home XDG_CACHE_HOME=$work/home XDG_DATA_HOME=$work/home

# A torus of 20,000 points that has all that points can be coloured by.
torus=$work/torus.ply
awk 'BEGIN {
    points = 20000
    print "ply\nformat ascii 1.0\nelement vertex " points
    fields = split("x y z nx ny nz intensity gps_time classification", names, " ")
    for (i = 1; i <= fields; i++) print "property float " names[i]
    print "end_header"
    for (i = 0; i < points; i++) {
        around = i * 2.399963229728653; tube = i * 6.283185307179586 / points
        nx = cos(tube) * cos(around); ny = sin(tube); nz = cos(tube) * sin(around)
        x = cos(around) + 0.4 * nx; y = 0.4 * ny; z = sin(around) + 0.4 * nz
        printf "%.6f %.6f %.6f %.6f %.6f %.6f ", x, y, z, nx, ny, nz
        printf "%.6f %.6f %d\n", 10 ^ (1.5 * ny), i / points, 1 + i * 8 / points
    }
}' >"$torus"

draw() { # draw NAME ARGUMENT…: runs $program, and leaves NAME.failed in $folder if that fails
    local name=$1 status=0
    shift
    "$program" render "$@" >"$folder/$name.log" 2>&1 || status=$?
    ((status == 0)) || echo "$name, status $status: $(head -n 1 "$folder/$name.log")" >"$folder/$name.failed"
}
picture() { # picture NAME INPUT OPTION…
    draw "$@" -o "$folder/$1.png"
}
video() { # video NAME ENDING INPUT OPTION…
    draw "$1" "${@:3}" --video "$folder/$1$2"
}
real() { # real NAME FILE OPTION…: `picture` of a file in DATA, if it is there
    if [[ -e $data/$2 ]]; then
        picture "$1" "$data/$2" "${@:3}"
    else
        echo "$data/$2" >>"$folder/skipped"
    fi
}

draw_all() { # draw_all PROGRAM FOLDER
    local program=$1 folder=$2 renderer value
    for renderer in cpu gpu; do
        local small=(--renderer "$renderer" --size 320x240)
        local demo=(demo: --frame 6 "${small[@]}") of_torus=("$torus" "${small[@]}")
        local points=("${demo[@]}" --primitive point)
        local surfels=("${demo[@]}" --primitive surfel) voxels=("${demo[@]}" --primitive voxel)

        for value in auto surfel voxel point; do
            picture "$renderer-primitive-$value" "${demo[@]}" --primitive "$value"
            picture "$renderer-torus-$value" "${of_torus[@]}" --primitive "$value"
        done
        for value in regular no-depth visibility two-pass enlarged two-pass-enlarged; do
            picture "$renderer-splatting-$value" "${surfels[@]}" --splatting "$value"
        done
        for value in none surfel vertex fragment; do
            picture "$renderer-lighting-$value" "${surfels[@]}" --lighting "$value"
        done
        for value in surfel voxel; do
            picture "$renderer-ao-$value" "${demo[@]}" --primitive "$value" --lighting lambert --ao on
            picture "$renderer-shadows-$value" "${demo[@]}" --primitive "$value" --lighting lambert \
                --lights three-point --shadows on
        done
        for value in auto drawn darker culled; do
            picture "$renderer-back-faces-$value" "${of_torus[@]}" --primitive surfel --back-faces "$value" \
                --clip-box=-2,-2,-2,2,0.1,2
        done
        for value in normals faces; do
            picture "$renderer-voxel-light-$value" "${voxels[@]}" --voxel-light "$value"
        done
        picture "$renderer-splat-scale" "${surfels[@]}" --splat-scale 1.5 --enlargement 1.3
        picture "$renderer-point-size" "${points[@]}" --point-size 3
        picture "$renderer-resolution" "${surfels[@]}" --resolution 0.5
        for value in fxaa supersample; do
            picture "$renderer-antialiasing-$value" "${surfels[@]}" --antialiasing "$value"
        done

        for value in '--lod 4' '--lod-level 5' '--lod-budget 2000'; do
            # shellcheck disable=SC2086 # an option and its value
            picture "$renderer-voxels${value// /-}" "${voxels[@]}" $value
            # shellcheck disable=SC2086
            picture "$renderer-surfels${value// /-}" "${surfels[@]}" --surfel-lod $value
        done
        for value in --spacing '--delta 0.05' '--depth 6' '--octant-points 8'; do
            # shellcheck disable=SC2086
            picture "$renderer-octree${value// /-}" "${voxels[@]}" $value
        done

        for value in height height:x normal distance time class uniform scalar:intensity; do
            picture "$renderer-colors-$value" "${of_torus[@]}" --colors "$value" --legend
        done
        for value in viridis turbo magma grey diverging; do
            picture "$renderer-color-map-$value" "${of_torus[@]}" --colors scalar --color-map "$value"
        done
        picture "$renderer-color-log" "${of_torus[@]}" --colors scalar --color-log --color-range 0.1..20 --legend
        picture "$renderer-color-range" "${of_torus[@]}" --colors height --color-range p10..p60 --primitive point

        for value in surfel voxel point; do
            picture "$renderer-eye-dome-$value" "${demo[@]}" --primitive "$value" --eye-dome on --eye-dome-strength 2
            picture "$renderer-clip-$value" "${demo[@]}" --primitive "$value" --clip-box=-1,0.4,-1,1,1.2,1
            picture "$renderer-orthographic-$value" "${demo[@]}" --primitive "$value" --orthographic
        done
        picture "$renderer-clip-outside" "${surfels[@]}" --clip-box=-1,0.4,-1,1,1.2,1 --clip-outside
        picture "$renderer-grid-and-scale-bar" "${surfels[@]}" --grid --scale-bar
        picture "$renderer-grid-orthographic" "${surfels[@]}" --grid --scale-bar --orthographic
        for value in dusk sky '#204060' '#204060-#ffffff' transparent; do
            picture "$renderer-background-$value" "${surfels[@]}" --background "$value"
        done
        picture "$renderer-transparent-eye-dome" "${points[@]}" --background transparent --eye-dome on --grid
        picture "$renderer-view" "${surfels[@]}" --up z --azimuth 200 --elevation 40 --fov 20
        picture "$renderer-near" "${surfels[@]}" --distance 0.6
        picture "$renderer-frame-all" "${demo[@]}" --frame-all

        picture "$renderer-change" "${demo[@]}" --change 3 --change-range 0.05 --legend
        picture "$renderer-onion" "${demo[@]}" --onion 2 --onion-step 2
        picture "$renderer-trail" "${demo[@]}" --trail 0,4000,8000
        # More than 4,096 pixels: drawn in parts.
        picture "$renderer-parts" demo: --frame 6 --renderer "$renderer" --size 4400x160 --primitive surfel \
            --eye-dome on --grid --distance 0.6
        picture "$renderer-frames-{frame}" demo: --frame 3..5 "${small[@]}"
        video "$renderer-turn-" '{frame}.png' demo: "${small[@]}" --turntable 4 --onion 1
        video "$renderer-turn" .gif demo: "${small[@]}" --turntable 4 --frame 6 --legend --colors height

        real "$renderer-real-bunny" static/bun_zipper.ply "${small[@]}"
        real "$renderer-real-fragment" static/fragment.pcd "${small[@]}" --colors scalar:curvature --legend
        real "$renderer-real-terrain" static/copc__lone-star.copc.laz "${small[@]}"
        real "$renderer-real-scan" sequences/ouster_os1_128_3scans/frame_0000.ply "${small[@]}"
        real "$renderer-real-scan-frame-all" sequences/ouster_os1_128_3scans/frame_0000.ply "${small[@]}" --frame-all
        real "$renderer-real-camera" sequences/pcl_openni_3frames/pcd "${small[@]}"
        real "$renderer-real-mesh" models/Fox/Fox.gltf "${small[@]}" --sample 30000
    done

    for value in storage uniform texture vertex compute; do
        for primitive in surfel voxel point; do
            picture "gpu-instancing-$value-$primitive" demo: --frame 6 --renderer gpu --size 320x240 \
                --instancing "$value" --primitive "$primitive"
        done
    done
    local coded=(demo: --frame 6 --renderer cpu --size 320x240 --primitive surfel)
    for value in disks masks pixels; do
        picture "cpu-footprint-$value" "${coded[@]}" --footprint "$value"
        picture "cpu-footprint-$value-lod" "${coded[@]}" --footprint "$value" --surfel-lod --lod 4
    done
    for value in 13 15 17; do
        picture "cpu-normal-bits-$value" "${coded[@]}" --footprint masks --normal-bits "$value"
    done
    for value in 0 2 3; do
        picture "cpu-offset-bits-$value" "${coded[@]}" --footprint pixels --offset-bits "$value"
    done
}

draw_all "$old" "$work/old" &
draw_all "$new" "$work/new"
wait $!

if [[ -e $work/old/skipped ]]; then
    sort -u "$work/old/skipped" | sed 's/^/skipped, not there: /'
fi
wrong=0
compared=0
report() { # report TEXT
    wrong=$((wrong + 1))
    echo "$1"
}
while IFS= read -r name; do
    before=$work/old/$name after=$work/new/$name
    case $name in
        *.log | skipped) continue ;;
        *.failed)
            for marker in "$before" "$after"; do
                [[ ! -e $marker ]] || report "not drawn: $(cat "$marker") (${marker%.failed}.log)"
            done
            continue
            ;;
    esac
    compared=$((compared + 1))
    if [[ ! -e $before || ! -e $after ]]; then
        [[ -e ${before%.*}.failed || -e ${after%.*}.failed ]] || report "drawn by one alone: $name"
    elif ! cmp --silent "$before" "$after"; then
        decibels=
        if [[ $name == *.png ]] && command -v compare >/dev/null; then
            decibels=" ($(compare -metric PSNR "$before" "$after" null: 2>&1 || true) dB)"
        fi
        report "differs: $name$decibels"
    fi
done < <(find "$work/old" "$work/new" -type f -printf '%f\n' | sort -u)

if ((wrong > 0)); then
    echo "$wrong of $compared pictures are wrong; they are in $work/old and $work/new"
    exit 1
fi
rm -r "$work"
echo "$compared pictures are the same"
