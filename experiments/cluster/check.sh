#!/usr/bin/env bash
# Does the workflow survive kill -9 of a shard and of Snakemake itself, and still give the bytes of a
# single run?   usage: check.sh PATH/TO/gnomon-sweep   (needs snakemake on the PATH)
set -euo pipefail
sweep=$(realpath "$1")
here=$(dirname "$(realpath "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
axes="--quick --case upc,book-r8-y7,exam-pcf --map 64,128,256,512 --format book,f32 --bias 1e-6:1e-1:log:200"
flow=(snakemake --snakefile "$here/Snakefile" --directory "$work" --cores 2 --quiet all
      --config "sweep=$sweep" "axes=$axes" shards=8 out=sweep threads=1)

# shellcheck disable=SC2086
"$sweep" $axes --out "$work/single" > /dev/null

# The id of a running shard of this check; empty while there is none.
shard() { pgrep -f "^$sweep .*--shard .* --out sweep/parts" | head -n 1 || true; }

"${flow[@]}" > "$work/log" 2>&1 &
snakemake=$!
victim=
until [ -n "$victim" ]; do victim=$(shard); done
kill -9 "$victim"
echo "killed a shard"
until [ "$(find "$work/sweep/parts" -name '*.items' | wc -l)" -ge 3 ]; do sleep 0.05; done
kill -9 "$snakemake"
wait "$snakemake" 2> /dev/null || true
while victim=$(shard); [ -n "$victim" ]; do kill -9 "$victim" 2> /dev/null || true; done
done=$(find "$work/sweep/parts" -name '*.items' | wc -l)
echo "killed Snakemake with $done of 8 shards done"

"${flow[@]}" --unlock > /dev/null 2>&1
"${flow[@]}" --rerun-incomplete > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
diff -r --exclude='*.tmp' "$work/single" "$work/sweep/report"
echo "resumed and merged: equal to a single run, byte for byte"
