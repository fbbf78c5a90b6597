#!/usr/bin/env bash
# The film test: four stills of every scene on one sheet, docs/film.jpg. Needs ffmpeg. Run it in the top folder.
#   docs/film.sh [WIDTHxHEIGHT]
set -euo pipefail
size=${1:-1280x720}
mkdir -p target/film
cargo run --release --locked --bin box_game -- \
  --script assets/scripts/film.ron --offscreen --no-settings --size "$size"
scenes=$(grep -o 'film/[a-z0-9-]*-1\.png' assets/scripts/film.ron | sed 's,film/,,; s,-1\.png,,')
n=0
for scene in $scenes; do
  for still in 1 2 3 4; do
    n=$((n + 1))
    cp "target/film/$scene-$still.png" "$(printf 'target/film/sheet-%03d.png' "$n")"
  done
done
ffmpeg -loglevel error -y -i target/film/sheet-%03d.png \
  -vf "scale=480:-1,tile=4x$((n / 4)):padding=4:color=white" -frames:v 1 -q:v 6 docs/film.jpg
rm target/film/sheet-*.png
