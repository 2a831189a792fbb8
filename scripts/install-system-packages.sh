#!/usr/bin/env bash
# Installs what building and running pointreel needs from the system, and only what is missing.
#
#     scripts/install-system-packages.sh [--with-tests]
#
# It looks for libraries and programs, not for packages, so that it is content on any distribution that has them.
# Where something is missing it installs Debian's and Ubuntu's package for it; without apt-get it says what is missing
# and fails.
set -euo pipefail

with_tests=no
case "${1-}" in
    "") ;;
    --with-tests) with_tests=yes ;;
    *) echo "usage: $0 [--with-tests]" >&2; exit 2 ;;
esac

# ldconfig is not on the PATH of ordinary users everywhere.
export PATH="$PATH:/usr/sbin:/sbin"
libraries=$(ldconfig -p 2>/dev/null || true)

missing=()
need() { # need PACKAGE WHAT: remembers a package and says why
    echo "missing: $2 (package $1)"
    missing+=("$1")
}
need_library() { # need_library SONAME PACKAGE WHY
    [[ "$libraries" == *"$1 "* ]] || need "$2" "$1, $3"
}
need_program() { # need_program NAME PACKAGE WHY
    command -v "$1" >/dev/null || need "$2" "$1, $3"
}

# The Vulkan loader finds drivers by their manifests; the environment can name others.
has_vulkan_driver() {
    [[ -n "${VK_DRIVER_FILES-}${VK_ICD_FILENAMES-}" ]] && return
    local manifests
    shopt -s nullglob
    manifests=({/usr/share,/usr/local/share,/etc,/usr/local/etc,"${XDG_DATA_HOME:-$HOME/.local/share}"}/vulkan/icd.d/*.json)
    shopt -u nullglob
    ((${#manifests[@]} > 0))
}

need_program cc gcc "which links Rust programs"
# Asked for its start-up code, a compiler answers with a path only if it has it.
[[ "$(cc -print-file-name=crt1.o 2>/dev/null)" == /* ]] \
    || need libc6-dev "the C library's start-up code, which the linker needs"
need_library libvulkan.so.1 libvulkan1 "the Vulkan loader"
has_vulkan_driver || need mesa-vulkan-drivers "a Vulkan driver (lavapipe draws on the CPU)"
# winit opens these when a window is made.
need_library libX11.so.6 libx11-6 "windows on X11"
need_library libX11-xcb.so.1 libx11-xcb1 "windows on X11"
need_library libXcursor.so.1 libxcursor1 "the mouse pointer on X11"
need_library libXi.so.6 libxi6 "mouse and touch on X11"
need_library libxkbcommon-x11.so.0 libxkbcommon-x11-0 "the keyboard on X11"
need_library libxkbcommon.so.0 libxkbcommon0 "the keyboard"
need_library libwayland-client.so.0 libwayland-client0 "windows on Wayland"
if [[ $with_tests == yes ]]; then
    need_program Xvfb xvfb "the display of the window test"
    need_program weston weston "its display on Wayland"
    need_program python3 python3 "the example of a live sender"
fi

if ((${#missing[@]} == 0)); then
    exit 0
fi
if ! command -v apt-get >/dev/null; then
    {
        echo "There is no apt-get here. Install with this system's package manager what Debian calls:"
        echo "    ${missing[*]}"
    } >&2
    exit 1
fi
as_root=()
if [[ $(id -u) != 0 ]]; then
    if ! command -v sudo >/dev/null; then
        echo "Neither root nor sudo. As root, run: apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
echo "installing: ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" </dev/null
