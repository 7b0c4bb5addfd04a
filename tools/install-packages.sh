#!/usr/bin/env bash
# Installs what Pagoda needs from Debian 12's own packages; asks for nothing that is there already.
#
#   tools/install-packages.sh [GROUP...]      default: build
#
# build     compiler, libraries, GLFW and Dear ImGui, a software GL: enough for tools/demo.sh
# test      GoogleTest, Embree (rays), Python (a second reader), gnuplot, Xvfb and xdotool (the window)
# report    gnuplot, for the figures of `pagoda bench --html`
# lint      clang-format, clang-tidy
# bench     Google Benchmark
# fuzz      clang with libFuzzer and the sanitizers' run time
# topology  OpenMesh, for the topology tests only: 218 packages, 524 MB
# --list prints the packages of the groups and installs nothing.
set -euo pipefail

packages_of() {
    case $1 in
    build) echo g++ cmake ninja-build ccache pkg-config \
        libcli11-dev libdraco-dev libegl-dev libepoxy-dev libfast-float-dev libfmt-dev libglm-dev \
        libmeshoptimizer-dev libpng-dev libspdlog-dev libtinygltf-dev libwebp-dev libxxhash-dev \
        nlohmann-json3-dev libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri \
        libglfw3-dev libimgui-dev fonts-dejavu-core ;;
    test) echo libgtest-dev libgmock-dev libembree-dev python3 gnuplot-nox xvfb xauth xdotool ;;
    report) echo gnuplot-nox ;;
    lint) echo clang-format clang-tidy git ;;
    bench) echo libbenchmark-dev ;;
    fuzz) echo clang libclang-rt-14-dev ;;
    topology) echo libopenmesh-dev ;;
    *) echo "install-packages.sh: no group '$1'; groups: build test report lint bench fuzz topology" >&2
       return 2 ;;
    esac
}

list_only=false
[ "${1:-}" = --list ] && { list_only=true; shift; }
[ $# -gt 0 ] || set -- build

wanted=()
for group in "$@"; do
    names=$(packages_of "$group")
    read -ra names <<<"$names"
    wanted+=("${names[@]}")
done
if $list_only; then
    printf '%s\n' "${wanted[@]}"
    exit 0
fi

if ! command -v apt-get >/dev/null; then
    echo "install-packages.sh: no apt-get here; install the like of: ${wanted[*]}" >&2
    exit 0
fi
missing=()
for package in "${wanted[@]}"; do
    dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null | grep -q '^ii' ||
        missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

echo "Installing ${#missing[@]} packages: ${missing[*]}" >&2
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "install-packages.sh: needs root; run: apt-get install --no-install-recommends ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
    [ -t 0 ] || as_root=(sudo -n) # nobody there to type a password
fi
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
