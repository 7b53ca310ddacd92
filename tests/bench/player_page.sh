#!/usr/bin/env bash
# Usage: player_page.sh [TUMBLE]
# The page of 300 colliding balls over 10 s: its size, how long it takes to open, and how many pictures a second it draws where the processor
# has to draw them (no graphics card: the slowest browser there is). Needs chromium. Prints one line; wall times, so the machine's load stands beside.
# Exit 1 where the page is ready later than MOST_READY_MS (2000) or draws fewer than LEAST_FPS (30) pictures a second: a busy machine without a graphics card may set others.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
tumble=${1:-$root/build/bin/tumble}
command -v chromium >/dev/null || { echo "player_page.sh: install chromium first" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TUMBLE_ROOT=$root
sed -e 's/"duration_s": 5/"duration_s": 10/; s/\[20, 10, 1\]/[20, 15, 1]/; s/\[0.39, 0.43, 0\]/[0.39, 0.29, 0]/; s/\[0.1, 0.1, 0\]/[0.08, 0.05, 0]/; s/"radius_m": 0.07 /"radius_m": 0.06 /' \
  -e '/"checks": \[/,/\]/d' -e 's/"grid": { "spacing_m": 0.5 },/"grid": { "spacing_m": 0.5 }/' "$root/assignments/a1_impulse/scenes/pong_200.json" >"$folder/pong_300.json"
"$tumble" run "$folder/pong_300.json" --modules reference --html "$folder/page.html" >"$folder/said" 2>"$folder/told" || { cat "$folder/said" "$folder/told" >&2; exit 1; }
events=$(grep -o 'events *.*' "$folder/said" | head -1)
# A script of the bench's own says after 8 s what it saw; the browser's log brings it here.
sed -i 's#</body>#<script>setTimeout(() => console.log("SAW ready=" + document.body.dataset.ready + " fps=" + document.body.dataset.fps + " error=" + (document.body.dataset.error || "")), 8000)</script></body>#' "$folder/page.html"
timeout 14 chromium --headless --no-sandbox --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync --disable-gpu \
  --enable-unsafe-swiftshader --window-size=1280,720 --user-data-dir="$folder/profile" --enable-logging=stderr "file://$folder/page.html#speed=1" 2>"$folder/log" >/dev/null || true
saw=$(grep -o 'SAW ready=[0-9]* fps=[0-9.]* error=.*' "$folder/log" | head -1)
[ -n "$saw" ] || { echo "the page did not come to life; the browser's log: " >&2; tail -5 "$folder/log" >&2; exit 1; }
word() { sed -n "s/.*$1=\([0-9.]*\).*/\1/p" <<<"$saw"; }
printf 'page of 300 balls, 10 s: %.2f MB, %s; opens in %s ms; %s pictures a second at 1280x720 drawn by the processor (load %s on %s cores)\n' \
  "$(stat -c %s "$folder/page.html" | awk '{print $1 / 1e6}')" "$events" "$(word ready)" "$(word fps)" "$(cut -d' ' -f1 /proc/loadavg)" "$(nproc)"
failed=0
too() { echo "player_page.sh: $1" >&2; failed=1; }
ready=$(word ready) fps=$(word fps) most_ms=${MOST_READY_MS:-2000} least_fps=${LEAST_FPS:-30}
awk -v a="${ready:-inf}" -v b="$most_ms" 'BEGIN { exit !(a != "inf" && a + 0 <= b + 0) }' || too "the page was ready after ${ready:-no number of} ms, expected at most $most_ms"
awk -v a="${fps:-0}" -v b="$least_fps" 'BEGIN { exit !(a + 0 >= b + 0) }' || too "${fps:-no number of} pictures a second, expected at least $least_fps (LEAST_FPS sets another limit)"
exit $failed
