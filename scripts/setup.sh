# SPDX-License-Identifier: Apache-2.0
# Sourced by the other scripts: the one list of Debian 12 packages, and what to do when some are missing.
# shellcheck shell=bash disable=SC2034

packages_build=(
    g++ cmake ninja-build pkg-config
    libtbb-dev nlohmann-json3-dev libxxhash-dev                        # the library
    libexpat1-dev libminizip-dev zlib1g-dev                            # its 3MF files, without which it builds; BCF
    ocl-icd-opencl-dev opencl-c-headers                                # its OpenCL devices; it builds without them
    libbullet-dev                                                      # the Bullet adapter
    libcli11-dev libfmt-dev libmeshoptimizer-dev                      # the program, its scenes and report
)
packages_core=( # scripts/test core: the library without OpenCL devices, and its own tests
    g++ cmake ninja-build pkg-config libtbb-dev nlohmann-json3-dev libxxhash-dev libexpat1-dev libminizip-dev zlib1g-dev libgtest-dev
    locales # a test makes a locale with a decimal comma
)
packages_demo=(glmark2-data) # the Stanford bunny
packages_test=(libgtest-dev libtinyobjloader-dev libtinygltf-dev libassimp-dev libcgal-dev libeigen3-dev pocl-opencl-icd locales
    assimp-testmodels libcgal-demo # mesh files of other programs
    python3-pip # brings the CUDA compiler that the kernels are checked with
    chromium python3) # open the pages
packages_bench=(libembree-dev libfcl-dev libode-dev)                  # peers of `raycontact-bench peers`; without Embree it is not built
packages_python=(python3-dev python3-venv)                            # the Python package; the rest comes from PyPI
packages_reference=(doxygen)
packages_package=(dpkg-dev file)
packages_all=(clang clang-tidy oclgrind valgrind)

say() { printf '== %s\n' "$*" >&2; }
die() { printf '%s: %s\n' "${0##*/}" "$*" >&2; exit 1; }

# install_packages GROUP...: what is not there yet. Root installs it; anyone else is told how to.
install_packages() {
    local -a wanted=() missing=()
    local group package
    for group in "$@"; do
        local -n list="packages_$group"
        wanted+=("${list[@]}")
    done
    if ! command -v dpkg-query >/dev/null; then
        say "not a Debian system: relying on what CMake finds (on Debian 12: ${wanted[*]})"
        return
    fi
    for package in "${wanted[@]}"; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    [ "$(id -u)" = 0 ] || die "these Debian packages are missing; install them, then run this again:
  sudo apt-get install --no-install-recommends ${missing[*]}"

    say "installing ${#missing[@]} Debian packages: ${missing[*]}"
    local log
    log=$(mktemp)
    if ! { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"; } \
        </dev/null >"$log" 2>&1; then
        tail -n 20 "$log" >&2
        rm -f "$log"
        die "apt-get could not install the packages (its last lines are above); is a Debian 12 mirror configured?"
    fi
    rm -f "$log"
}

# configure PRESET FOLDER [cmake options]: from the repository's root, with Ninja, and ccache where it is installed.
configure() {
    local preset=$1 folder=$2
    shift 2
    local -a options=(--preset "$preset" -B "$folder")
    # A build folder keeps the generator it was made with; asking for another one is an error.
    [ -e "$folder/CMakeCache.txt" ] || options+=(-G Ninja)
    if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
    say "configuring $folder"
    cmake "${options[@]}" "$@" >/dev/null
}

jobs() { nproc; }

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit
