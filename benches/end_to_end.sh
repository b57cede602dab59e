#!/usr/bin/env bash
# Compares whole processes, file to file: toon-raster and resvg's own program.
#
#     benches/end_to_end.sh [FILE...]
#
# Without files: some samples. Settings, by environment:
#
#     TOON_RASTER   our program                      (target/release/toon-raster, built if missing)
#     RESVG         resvg's                          (resvg)
#     WIDTHS        widths in pixels                 (512 2048)
#     RUNS          timed runs of each, interleaved  (15)
#     ARGS          more arguments for toon-raster   (none; say "-t 1")
#
# Prints a Markdown table: medians of the wall time in ms (bash's fork and exec are in both), peak
# memory in MiB (the least of three runs; needs GNU time, "-" without), size of the PNG in KB.
# resvg's program packs with the png crate's defaults.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "$0")/.."

ours=${TOON_RASTER:-target/release/toon-raster}
theirs=${RESVG:-resvg}
runs=${RUNS:-15}
read -ra widths <<<"${WIDTHS:-512 2048}"
read -ra more <<<"${ARGS:-}"
files=("$@")
[[ $# -gt 0 ]] || files=(samples/fox.svg samples/island.svg samples/planet.svg samples/corpus/twemoji-pinata.svg)

[[ -x $ours ]] || cargo build --release --quiet
command -v "$theirs" >/dev/null || {
    echo "end_to_end.sh: $theirs is not there (set RESVG, or cargo install resvg)" >&2
    exit 2
}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Fonts and progress play no part in these files; both programs get the same arguments.
run() { # PROGRAM FILE WIDTH OUT
    if [[ $1 == "$ours" ]]; then
        "$ours" "${more[@]}" --quiet -w "$3" "$2" "$4"
    else
        "$theirs" --quiet -w "$3" "$2" "$4"
    fi
}

timed() { # as run; milliseconds
    local from=$EPOCHREALTIME
    run "$@"
    local to=$EPOCHREALTIME
    echo $(((${to/./} - ${from/./}))) | awk '{printf "%.3f\n", $1 / 1000}'
}

median() { sort -n | awk '{a[NR] = $1} END {print (NR % 2) ? a[(NR + 1) / 2] : (a[NR / 2] + a[NR / 2 + 1]) / 2}'; }

peak() { # as run; MiB
    [[ -x /usr/bin/time ]] || { echo -; return; }
    local arguments=(--quiet -w "$3" "$2" "$4") i
    [[ $1 != "$ours" ]] || arguments=("${more[@]}" "${arguments[@]}")
    for i in 1 2 3; do
        /usr/bin/time -f %M -o "$scratch/peak" "$1" "${arguments[@]}"
        cat "$scratch/peak"
    done | sort -n | awk 'NR == 1 {printf "%.1f\n", $1 / 1024}'
}

echo "| drawing | width | toon-raster ms | resvg ms | ratio | toon-raster MiB | resvg MiB | toon-raster KB | resvg KB |"
echo "|---|---|---|---|---|---|---|---|---|"
for file in "${files[@]}"; do
    for width in "${widths[@]}"; do
        run "$ours" "$file" "$width" "$scratch/ours.png"
        run "$theirs" "$file" "$width" "$scratch/theirs.png"
        : >"$scratch/ours" && : >"$scratch/theirs"
        for ((i = 0; i < runs; i++)); do
            timed "$ours" "$file" "$width" "$scratch/ours.png" >>"$scratch/ours"
            timed "$theirs" "$file" "$width" "$scratch/theirs.png" >>"$scratch/theirs"
        done
        a=$(median <"$scratch/ours")
        b=$(median <"$scratch/theirs")
        awk -v name="$(basename "$file")" -v w="$width" -v a="$a" -v b="$b" \
            -v ma="$(peak "$ours" "$file" "$width" "$scratch/ours.png")" \
            -v mb="$(peak "$theirs" "$file" "$width" "$scratch/theirs.png")" \
            -v sa="$(wc -c <"$scratch/ours.png")" -v sb="$(wc -c <"$scratch/theirs.png")" \
            'BEGIN {printf "| %s | %d | %.1f | %.1f | %.2f | %s | %s | %.0f | %.0f |\n",
                name, w, a, b, a / b, ma, mb, sa / 1000, sb / 1000}'
    done
done
