#!/usr/bin/env bash
# What effects cost to drawings without them, counted in instructions, which do not depend on who else uses the
# machine.
#
#     benches/instructions.sh                 # the program as it is
#     benches/instructions.sh --against REV   # and as it was at a revision, built in a folder of its own
#
# Renders flat drawings of samples/ on one thread under valgrind's callgrind and prints for each the instructions
# executed; how many of them in functions of effects (the modules layers, texture, effects, scene::color_map,
# scene::gradient_shader and scene::shader); and how many in lines of their files that the compiler has put into other functions, such as asking
# a shape whether it is flat. Ends with 1 if a flat drawing executes any of the former or more than 1 in 2,000 of the
# latter, or if a drawing with effects executes none, which would mean that nothing is measured. With --against,
# the ratio of all instructions is printed too.
#
# Needs valgrind (`apt-get install valgrind`). Takes a minute or two, and the time to build.
set -euo pipefail
cd "$(dirname "$0")/.."

revision=
[[ ${1:-} == --against ]] && revision=${2:?--against needs a revision}
command -v valgrind >/dev/null || { echo "valgrind is not installed" >&2; exit 2; }

flat=(fox island planet strokes even-odd stacked burst)
with_effects=(effects gradients highlights)
width=512

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"; [[ -z $revision ]] || git worktree remove --force "$scratch-source" 2>/dev/null || true' EXIT

target=${CARGO_TARGET_DIR:-$PWD/target}
cargo build --release --quiet
program=$target/release/toon-raster

other=
if [[ -n $revision ]]; then
    git worktree add --quiet --detach "$scratch-source" "$revision"
    (cd "$scratch-source" && CARGO_TARGET_DIR=$target/instructions cargo build --release --quiet)
    other=$target/instructions/release/toon-raster
fi

# Instructions of one program on one drawing: all, those in effects' functions, and inlined from their files.
count() {
    local program=$1 drawing=$2 out=$scratch/callgrind
    valgrind --tool=callgrind --callgrind-out-file="$out" "$program" "samples/$drawing.svg" \
        "$scratch/out.rgba" --format rgba -w "$width" -t 1 2>/dev/null
    awk '
        # Names are given once, as "(3) name", and then by number.
        function named(kind, text,    key) {
            match(text, /^\([0-9]+\)/)
            key = kind substr(text, RSTART, RLENGTH)
            if (length(text) > RLENGTH) names[key] = substr(text, RLENGTH + 2)
            return names[key]
        }
        /^fn=/ { fun = named("function", substr($0, 4)); next }
        /^(fl|fi|fe)=/ { file = named("file", substr($0, 4)); next }
        # What is called does not change where we are, but may be named for the first time.
        /^cfn=/ { named("function", substr($0, 5)); next }
        /^(cfi|cfl)=/ { named("file", substr($0, 5)); next }
        # The line after a call has what it costs in all; its own instructions are counted there.
        /^calls=/ { getline; next }
        /^[0-9+*-]/ && NF >= 2 {
            all += $2
            if (fun ~ /^<?toon_raster::(layers|texture|effects|scene::(color_map|gradient_shader|shader))::/) own += $2
            else if (file ~ /src\/(layers|texture|effects)(\.rs$|\/)|src\/scene\/(color_map|gradient_shader|shader)\.rs$|src\/scene\/gradient_shader\//) inlined += $2
        }
        END { printf "%d %d %d\n", all, own, inlined }' "$out"
}

failed=0
printf '%-12s %15s %12s %10s' drawing instructions 'in effects' inlined
[[ -z $other ]] || printf ' %15s %8s' "at $revision" ratio
printf '\n'
for drawing in "${flat[@]}" "${with_effects[@]}"; do
    [[ -e samples/$drawing.svg ]] || continue
    read -r all own inlined < <(count "$program" "$drawing")
    printf '%-12s %15d %12d %10d' "$drawing" "$all" "$own" "$inlined"
    if [[ -n $other ]]; then
        read -r before _ _ < <(count "$other" "$drawing")
        printf ' %15d %8.4f' "$before" "$(awk -v a="$all" -v b="$before" 'BEGIN { print b ? a / b : 0 }')"
    fi
    printf '\n'
    if [[ " ${flat[*]} " == *" $drawing "* ]]; then
        ((own == 0 && inlined * 2000 <= all)) || { echo "$drawing is flat, and yet runs effects" >&2; failed=1; }
    else
        ((own > 0)) || { echo "$drawing has effects, and none is found to run" >&2; failed=1; }
    fi
done
exit "$failed"
