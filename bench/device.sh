#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Steps and kernels of every GPU of this machine: runs the tests of devices on it (under compute-sanitizer, too, where
# that is installed), checks the hash of each range of steps, method and caster against the CPU's (and against those of
# the machine that packed), times kernels and whole steps, measures bandwidth. Writes a CSV and a log to
# ${OUT:-bench/results/<machine>}. Needs no arguments, no root and, packed or built, no network. Without a GPU it runs
# on opencl:0 and says so. Tests are run where build/ has them (scripts/test builds them).
#
#   bench/device.sh                     builds first, unless it finds a pack or RAYCONTACT_BINARY=PROGRAM, which has
#                                       raycontact-bench beside it
#   bench/device.sh --pack DIR          builds, and gathers in DIR what a bare machine needs: copy DIR, run DIR/device.sh
#
# A pack is found beside this script, or in the folder device-pack beside it. Status: 0 fine, 1 a device failed or its
# contacts are not the CPU's (after everything was written), 2 something is missing.
#
# By environment variables: DEVICES (list), STEPS (ranges), METHODS, COPIES (list; more than 1: caster bvh only), RUNS,
# BASIC_STEPS, BODIES (list, may be empty), RECORDING, TESTS (none: only measure), OUT. RAYCONTACT_NVRTC is passed on to the program.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
default_ranges="60:76 200:232" # the avalanche lands; it lies and creeps
recorded_steps=240
pack_mib=60
# Program and what it is asked for. The smallest case is the one for a checker of every access.
tests=('opencl_device_test queue.*:scan.*:driver.kernels*' 'opencl_kernels_test devices.*:small.*' 'opencl_scenes_test *' 'device_pairs_test *')
checked='opencl_kernels_test small.*'
checkers=(memcheck racecheck initcheck synccheck)

say() { printf '== %s\n' "$*" >&2; }
die() { printf 'device.sh: %s\n' "$*" >&2; exit 2; }

usage() { sed -n '/^# Steps/,/^# BASIC/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; }

# build: build/bin/raycontact and raycontact-bench. Says what a machine without packages lacks.
build() {
    local tool
    local -a missing=()
    for tool in cmake ninja "${CXX:-c++}"; do command -v "$tool" >/dev/null || missing+=("$tool"); done
    "$here/../scripts/bench" >/dev/null && return
    [ ${#missing[@]} = 0 ] || say "missing here: ${missing[*]}"
    die "the programs could not be built: that takes cmake, ninja, a C++20 compiler and the packages of scripts/setup.sh.
  Without them or without a network, run \`bench/device.sh --pack DIR\` on a machine that has them, copy DIR here and run
  DIR/device.sh, or name a program with RAYCONTACT_BINARY=PROGRAM"
}

# hashes_of CSV: method, caster, first step, steps, copies, hash. Quoted fields may hold commas.
hashes_of() {
    sed 's/"[^"]*"/q/g' "$1" | awk -F, '
        $1 == "date" { for (i = 1; i <= NF; ++i) at[$i] = i; next }
        $at["what"] == "step" { print $at["method"], $at["caster"], $at["first"], $at["steps"], $at["copies"], $at["hash"] }'
}

# ------------------------------------------------------------------------------------------------------------- packing

# libraries_of PROGRAM: those that a machine with no packages lacks. glibc's own must be that machine's.
libraries_of() {
    ldd "$1" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' \
        | grep -vE '/(libc|libm|libpthread|libdl|librt|libresolv|libcuda|libnvidia-[a-z-]*|ld-linux[^/]*)\.so' | sort -u
}

pack() {
    local pack=$1 nvrtc library program
    command -v xz >/dev/null || die "--pack needs xz (Debian: xz-utils)"
    build
    cd "$here/.."
    mkdir -p "$pack"
    pack=$(cd "$pack" && pwd)
    [ -z "$(ls -A "$pack")" ] || [ -e "$pack/pack.txt" ] || die "--pack $pack: is not empty and no pack; name another folder"
    local work
    work=$(mktemp -d)
    # shellcheck disable=SC2064 # its value now
    trap "rm -rf '$work'" EXIT

    say "programs, tests and libraries"
    mkdir "$work/libraries" "$work/tests"
    cp build/bin/raycontact build/bin/raycontact-bench "$work/"
    if [ -x build/bin/opencl_kernels_test ]; then
        cp build/bin/opencl_*_test "$work/tests/"
    else
        say "build/ has no tests of devices: the pack measures, and checks hashes alone; scripts/test builds them"
    fi
    for program in "$work/raycontact" "$work/raycontact-bench" "$work"/tests/*; do
        [ -x "$program" ] || continue
        strip "$program" 2>/dev/null || true
        while read -r library; do cp -L "$library" "$work/libraries/"; done < <(libraries_of "$program")
    done
    tar -C "$work" -cf - raycontact raycontact-bench tests libraries | xz -3 -T0 >"$pack/program.tar.xz"

    say "a recording, and its hashes on this CPU"
    build/bin/raycontact run avalanche --steps "$recorded_steps" --speculative off --json --record "$pack/avalanche.glb" >/dev/null
    local range
    : >"$pack/hashes.txt"
    for range in $default_ranges; do
        rm -rf "$work/golden"
        build/bin/raycontact-bench device --recording "$pack/avalanche.glb" --steps "$range" --devices cpu --runs 1 \
            --basic-steps "${BASIC_STEPS:-4}" --out "$work/golden" >/dev/null 2>&1
        hashes_of "$(find "$work/golden" -name '*.csv')" >>"$pack/hashes.txt"
    done
    cp "${BASH_SOURCE[0]}" "$pack/device.sh" 2>/dev/null || cp "$here/device.sh" "$pack/device.sh"
    { date -u +%F; git rev-parse --short=12 HEAD 2>/dev/null || echo unknown; } >"$pack/pack.txt"

    rm -f "$pack/nvrtc.tar.xz"
    nvrtc=$(find -L build/nvrtc -name 'libnvrtc.so*' -print -quit 2>/dev/null || true)
    if [ -n "$nvrtc" ]; then
        say "NVRTC"
        # Only the library and its builtins: the .alt ones are the same for other uses.
        mkdir "$work/nvrtc"
        cp -L "$(dirname "$nvrtc")"/libnvrtc.so* "$(dirname "$nvrtc")"/libnvrtc-builtins.so* "$work/nvrtc/"
        tar -C "$work/nvrtc" -cf - . | xz -3 -T0 >"$work/nvrtc.tar.xz"
        if [ $(($(du -sk "$pack" | cut -f1) + $(du -k "$work/nvrtc.tar.xz" | cut -f1))) -le $((pack_mib * 1024)) ]; then
            mv "$work/nvrtc.tar.xz" "$pack/"
        else
            say "NVRTC is left out: with it the pack would exceed $pack_mib MiB. The machine needs its own (CUDA toolkit)"
        fi
    else
        say "no build/nvrtc: the pack has no NVRTC, which CUDA devices need; scripts/fetch-nvrtc brings it"
    fi
    [ "$(du -sk "$pack" | cut -f1)" -le $((pack_mib * 1024)) ] || die "$pack exceeds $pack_mib MiB"
    say "$(du -sh "$pack" | cut -f1) in $pack: copy it, then run device.sh there"
}

# ------------------------------------------------------------------------------------------------------------- running

# unpack ARCHIVE FOLDER: some bare machines have no xz.
unpack() {
    mkdir -p "$2"
    if command -v xz >/dev/null; then
        xz -dc "$1" | tar -C "$2" -xf -
    elif command -v python3 >/dev/null; then
        python3 -c 'import lzma, shutil, sys; shutil.copyfileobj(lzma.open(sys.argv[1]), sys.stdout.buffer)' "$1" | tar -C "$2" -xf -
    else
        die "$1 needs xz or python3 to be unpacked; install xz-utils"
    fi
}

# The driver's OpenCL is known to the loader by a file that containers often lack.
name_nvidia_opencl() {
    compgen -G '/etc/OpenCL/vendors/*nvidia*' >/dev/null && return
    ldconfig -p 2>/dev/null | grep -q 'libnvidia-opencl\.so\.1' || return 0
    mkdir -p "$work/vendors"
    cp /etc/OpenCL/vendors/*.icd "$work/vendors/" 2>/dev/null || true
    echo libnvidia-opencl.so.1 >"$work/vendors/nvidia.icd"
    export OCL_ICD_VENDORS="$work/vendors"
}

case "${1:-}" in
    "") ;;
    --pack) [ $# = 2 ] || die "--pack takes a folder"; pack "$2"; exit 0 ;;
    --help | -h) usage; exit 0 ;;
    *) die "unknown: $1; see --help" ;;
esac

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
pack=
test_folder=$here/../build/bin
for folder in "$here" "$here/device-pack"; do
    if [ -z "$pack" ] && [ -e "$folder/pack.txt" ]; then pack=$folder; fi
done

if [ -n "${RAYCONTACT_BINARY:-}" ]; then
    program=$RAYCONTACT_BINARY
elif [ -n "$pack" ]; then
    say "using the pack in $pack, of $(tr '\n' ' ' <"$pack/pack.txt")"
    unpack "$pack/program.tar.xz" "$work"
    program=$work/raycontact
    test_folder=$work/tests
    export LD_LIBRARY_PATH="$work/libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
    if [ -e "$pack/nvrtc.tar.xz" ] && [ -z "${RAYCONTACT_NVRTC:-}" ]; then
        unpack "$pack/nvrtc.tar.xz" "$work/nvrtc"
        export RAYCONTACT_NVRTC="$work/nvrtc"
    fi
else
    build
    program=$here/../build/bin/raycontact
fi
benchmarks=$(dirname "$program")/raycontact-bench
for file in "$program" "$benchmarks"; do [ -x "$file" ] || die "$file is no program"; done
if ! "$program" devices >"$work/devices.txt" 2>"$work/error.txt"; then
    cat "$work/error.txt" >&2
    ldd "$program" 2>/dev/null | grep 'not found' >&2 || true
    die "$program does not run here (its message is above): a library or a newer glibc is missing; pack on this system's release"
fi
name_nvidia_opencl
"$program" devices >"$work/devices.txt" 2>&1 || true

gpus=$(awk '$2 == "gpu:" && !/not usable/ { print $1 }' "$work/devices.txt" | tr '\n' ' ')
copies=${COPIES:-1 15 140} # of some 7 000 pairs: to 10^5 and 10^6
note=
if [ -n "${DEVICES:-}" ]; then
    devices=$(tr ',' '\n' <<<"$DEVICES" | grep -vx cpu | tr '\n' ' ' || true)
elif [ -n "$gpus" ]; then
    devices=$gpus
else
    copies=${COPIES:-1}
    if grep -q '^opencl:0 ' "$work/devices.txt"; then
        devices=opencl:0
        note="NO GPU that can be used here: these figures are of opencl:0, $(awk '$1 == "opencl:0" { $1 = ""; print }' "$work/devices.txt")"
    else
        devices=
        note="NO GPU and no OpenCL device here: these figures are of the CPU alone"
    fi
    say "$note"
fi

recording=${RECORDING:-}
if [ -z "$recording" ] && [ -n "$pack" ]; then recording=$pack/avalanche.glb; fi
if [ -z "$recording" ]; then
    recording=$work/avalanche.glb
    say "recording an avalanche"
    "$program" run avalanche --steps "$recorded_steps" --json --record "$recording" >/dev/null
fi

log=$work/log.txt
csv=$work/all.csv
status=0
slug=
{
    date -u
    uname -srm
    [ -z "$note" ] || echo "$note"
    nvidia-smi 2>/dev/null || echo "no nvidia-smi"
    cat "$work/devices.txt"
} >"$log"

# run_test DEVICE HOW...: its last lines tell; goes on after a failure.
run_test() {
    local device=$1 rc=0
    shift
    { echo; echo "RAYCONTACT_TEST_DEVICE=$device $*"; } >>"$log"
    RAYCONTACT_TEST_DEVICE=$device RAYCONTACT_CACHE=$work/cache timeout 240 "$@" >"$work/test.txt" 2>&1 || rc=$?
    grep -E '^\[  (PASSED|FAILED|SKIPPED) |^=====.*(ERROR SUMMARY|RACECHECK SUMMARY)|Failure$|error' "$work/test.txt" | head -n 40 >>"$log" || true
    if [ $rc = 0 ]; then
        say "$device: $(basename "$1") passed"
    else
        status=1
        tail -n 40 "$work/test.txt" >>"$log"
        say "$device: $* FAILED with status $rc: $(tail -n 1 "$work/test.txt")"
    fi
}

# test_device DEVICE: each test of any device, then the smallest under each checker of compute-sanitizer.
test_device() {
    local device=$1 one checker
    for one in "${tests[@]}"; do
        [ ! -x "$test_folder/${one%% *}" ] || run_test "$device" "$test_folder/${one%% *}" --gtest_filter="${one#* }"
    done
    case "$device" in cuda:*) ;; *) return 0 ;; esac
    command -v compute-sanitizer >/dev/null && [ -x "$test_folder/${checked%% *}" ] || return 0
    for checker in "${checkers[@]}"; do
        run_test "$device" compute-sanitizer --tool "$checker" --error-exitcode 1 "$test_folder/${checked%% *}" \
            --gtest_filter="${checked#* }"
    done
}

# measure DEVICE RANGE COPIES: on the CPU too, so that each table has both. Goes on after a failure.
measure() {
    local device=$1 range=$2 number=$3 runs=${RUNS:-5} found rc=0
    # What takes a hundred times as long needs fewer steps, and few runs of the CPU.
    if [ "$number" != 1 ]; then
        range=${range%%:*}:$((${range%%:*} + 6))
        if [ "$device" = cpu ]; then runs=1; fi
    fi
    local -a how=(--recording "$recording" --steps "$range" --devices "$device" --copies "$number" --runs "$runs"
        --basic-steps "${BASIC_STEPS:-4}")
    [ -z "${METHODS:-}" ] || how+=(--methods "$METHODS")
    if [ "$number" != 1 ]; then how+=(--casters bvh); fi
    say "$device, steps $range, $number times"
    rm -rf "$work/out"
    { echo; echo "raycontact-bench device ${how[*]}"; } >>"$log"
    "$benchmarks" device "${how[@]}" --out "$work/out" >>"$log" 2>&1 || rc=$?
    if [ $rc != 0 ]; then
        status=1
        say "FAILED with status $rc: $(tail -n 1 "$log")"
    fi
    found=$(find "$work/out" -name '*.csv' 2>/dev/null || true)
    [ -n "$found" ] || return 0
    slug=$(basename "$(dirname "$found")")
    if [ -e "$csv" ]; then tail -n +2 "$found" >>"$csv"; else cp "$found" "$csv"; fi
}

if [ "${TESTS:-}" != none ]; then
    for device in $devices; do test_device "$device"; done
fi
for number in $copies; do
    for range in ${STEPS:-$default_ranges}; do
        for device in cpu $devices; do measure "$device" "$range" "$number"; done
    done
done

# Pairs that each device finds among many bodies; for the log alone.
for number in ${BODIES-4096 100000}; do
    for device in $devices; do
        say "$device, $number bodies"
        { echo; echo "raycontact-bench scale --devices $device --bodies $number"; } >>"$log"
        "$benchmarks" scale --devices "$device" --bodies "$number" --steps 5 >>"$log" 2>&1 || status=1
    done
done

# The CPU's own contacts against those of the machine that packed.
if [ -n "$pack" ] && [ -e "$csv" ] && [ -z "${RECORDING:-}" ]; then
    hashes_of "$csv" | sort -u >"$work/found.txt"
    different=$(awk 'NR == FNR { golden[$1,$2,$3,$4,$5] = $6; next }
        ($1,$2,$3,$4,$5) in golden { ++same; if (golden[$1,$2,$3,$4,$5] != $6) print "HASH of", $0, "was", golden[$1,$2,$3,$4,$5], "where it was packed" }
        END { print same + 0, "hashes compared with those of the machine that packed" }' "$pack/hashes.txt" "$work/found.txt")
    printf '\n%s\n' "$different" | tee -a "$log" >&2
    if grep -q '^HASH' <<<"$different"; then status=1; fi
fi

[ -n "$slug" ] || { cat "$log" >&2; die "nothing was measured; the log is above"; }
out=${OUT:-$here/results/$slug}
mkdir -p "$out"
name=device-$(date -u +%F)
cp "$csv" "$out/$name.csv"
cp "$log" "$out/$name.log"
say "written: $out/$name.csv and .log"
[ $status = 0 ] || say "FAILED: a device or a hash; see the log"
exit $status
