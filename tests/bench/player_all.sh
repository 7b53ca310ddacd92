#!/usr/bin/env bash
# Usage: player_all.sh [TUMBLE [SCENE...]]
# Every scene of the listing, or those named, run for 0.2 s, made into a page and opened in headless Chromium: the page must come to life, without an error, and bodies
# must be seen in it (pixels that change when they are hidden). A line a scene; exit 1 where one fails. Minutes; needs chromium and the reference modules.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
tumble=${1:-$root/build/bin/tumble}
least_pixels=${LEAST_PIXELS:-20}   # of 320 x 240 that bodies colour: a ball of 5 pixels, far away
command -v chromium >/dev/null || { echo "player_all.sh: install chromium first" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TUMBLE_ROOT=$root
if [ $# -gt 1 ]; then scenes=("${@:2}")
else mapfile -t scenes < <("$tumble" run no_scene_has_this_name 2>&1 | sed -n 's/^  \([a-z0-9_]*\)  *.*/\1/p')
fi
[ ${#scenes[@]} -gt 0 ] || { echo "player_all.sh: the listing names no scene" >&2; exit 1; }

# Says in the browser's log what the page came to. A picture is read right after it was drawn, with and without the bodies.
cat >"$folder/look.js" <<'JS'
const look = () => {
  const said = document.body.dataset, { picture, player } = window.tumble || {};
  const told = pixels => console.log(`SAW ready=${said.ready || ''} pixels=${pixels} error=${said.error || ''}`);
  if (!picture) return told(0);
  player.goTo(player.end);
  const pixels = () => {
    picture.draw();
    const small = document.createElement('canvas'), g = small.getContext('2d');
    [small.width, small.height] = [320, 240];
    g.drawImage(picture.canvas, 0, 0, 320, 240);
    return g.getImageData(0, 0, 320, 240).data;
  };
  const shown = pixels();
  for (const stage of picture.stages) for (const child of stage.scene.children) if (child.isMesh && child !== stage.ground) child.visible = false;
  const hidden = pixels();
  let changed = 0;
  for (let i = 0; i < shown.length; i += 4) if (Math.abs(shown[i] - hidden[i]) + Math.abs(shown[i + 1] - hidden[i + 1]) + Math.abs(shown[i + 2] - hidden[i + 2]) > 30) ++changed;
  told(changed);
};
setTimeout(look, 2500);
JS

failed=0
fail() { printf '%-26s FAILED  %s\n' "$1" "$2"; failed=$((failed + 1)); }
for scene in "${scenes[@]}"; do
  page=$folder/page.html
  rm -f "$page"
  # A run of 0.2 s need not fulfil what the scene asks of its end: whether there is a page counts.
  timeout 300 "$tumble" run "$scene" --modules reference --html "$page" --duration-s 0.2 >"$folder/said" 2>&1 || true
  [ -s "$page" ] || { fail "$scene" "no page: $(tail -1 "$folder/said")"; continue; }
  awk -v file="$folder/look.js" '/<\/body>/ { printf "<script>"; while ((getline line < file) > 0) print line; printf "</script>" } { print }' "$page" >"$folder/look.html"
  timeout 60 chromium --headless --no-sandbox --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync --use-gl=angle --use-angle=swiftshader \
    --enable-unsafe-swiftshader --window-size=640,480 --virtual-time-budget=4000 --user-data-dir="$folder/profile" --enable-logging=stderr --dump-dom "file://$folder/look.html" >/dev/null 2>"$folder/log" || true
  saw=$(grep -o 'SAW ready=[0-9]* pixels=[0-9]* error=.*' "$folder/log" | head -1 | sed 's/", source:.*//')
  ready=$(sed -n 's/.*ready=\([0-9]*\).*/\1/p' <<<"$saw") pixels=$(sed -n 's/.*pixels=\([0-9]*\).*/\1/p' <<<"$saw") error=$(sed -n 's/.*error=\(.*\)/\1/p' <<<"$saw")
  if [ -z "$saw" ]; then fail "$scene" "the page said nothing: $(tail -1 "$folder/log")"
  elif [ -n "$error" ]; then fail "$scene" "$error"
  elif [ -z "$ready" ]; then fail "$scene" "the page was not ready after 2.5 s"
  elif [ "$pixels" -lt "$least_pixels" ]; then fail "$scene" "blank: bodies colour $pixels of 320 x 240 pixels, expected $least_pixels or more"
  else printf '%-26s plays   %s pixels of bodies\n' "$scene" "$pixels"
  fi
done
printf '%d of %d scenes play\n' $((${#scenes[@]} - failed)) ${#scenes[@]}
[ "$failed" -eq 0 ]
