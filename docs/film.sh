#!/usr/bin/env bash
# The film test: stills of the first eight seconds of every scene, and the last with plots in the light theme, on one
# sheet for each size of the window. A scene passes if a stranger can retell its row. Needs ffmpeg. In the top folder:
#   docs/film.sh             makes docs/film.jpg (1280x720) and target/film/1920x1080.jpg
#   GAME=… docs/film.sh      uses this program instead of building it
set -euo pipefail
command -v ffmpeg >/dev/null || { echo "docs/film.sh needs ffmpeg"; exit 1; }
game=${GAME:-cargo run --release --locked --bin box_game --}
script() { # of the scenes whose ids stand on the lines of the input, to put pictures into a folder
  LC_ALL=C awk -v folder="$1" '
    function at(t, actions) { printf "(at: %.2f, actions: [%s]),\n", start + t, actions }
    function still(t) { at(t, sprintf("ScreenshotTo(\"%s/%03d.png\")", folder, ++n)) }
    BEGIN { print "["; at(0, "TogglePlots") }
    {
      push = $1 == "playground" ? "Push((direction: (1, 1, 0), off_center: true))" : ""
      at(0, "SelectScene(\"" $1 "\")")
      still(0.5); at(0.8, push)
      still(2.0); at(2.6, push)
      still(4.5)
      still(8.0); at(8.1, "TogglePlots, ToggleTheme")
      still(8.2); at(8.3, "TogglePlots, ToggleTheme")
      start += 8.4
    }
    END { at(0, "Quit"); print "]" }'
}
scenes=$($game --list-scenes | awk '{ print $1 }')
sheet() { # size, file
  local folder=target/film/$1
  mkdir -p "$folder"
  script "$folder" <<<"$scenes" >"$folder/script.ron"
  $game --script "$folder/script.ron" --offscreen --no-settings --size "$1"
  ffmpeg -loglevel error -y -i "$folder/%03d.png" -frames:v 1 -q:v 9 -pix_fmt yuvj420p \
    -vf "scale=320:-1:flags=lanczos,tile=5x$(wc -l <<<"$scenes"):padding=4:color=white" "$2"
}
sheet 1280x720 docs/film.jpg
sheet 1920x1080 target/film/1920x1080.jpg
