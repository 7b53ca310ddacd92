#!/usr/bin/env bash
# Usage: build_handouts.sh TUMBLE FOLDER
# Builds the handouts of a tree like a student's (no reference solutions, figures as they came), looks at what comes out, then sees a broken link
# and a missing figure refused. Exit 77: pandoc or LaTeX is not installed, nothing was tested.
set -euo pipefail
tumble=$1 folder=$2 root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
for program in pandoc pdflatex; do
  command -v "$program" >/dev/null || { echo "skipped: $program is not installed"; exit 77; }
done
fail() { echo "build_handouts: $*" >&2; exit 1; }
rm -rf "$folder"
mkdir -p "$folder/tree"
ln -s "$root/assignments" "$root/framework" "$root/tests" "$root/models" "$folder/tree/"
cp -r "$root/handouts" "$folder/tree/"
export TUMBLE_ROOT=$folder/tree

"$tumble" handouts --out "$folder/out" >"$folder/said" 2>&1 || { cat "$folder/said" >&2; fail "the handouts were not built"; }
for handout in "$root"/handouts/*.md; do
  name=$(basename "$handout" .md) page=$folder/out/$(basename "$handout" .md).html
  formulas=$({ grep -o '<math' "$page" || true; } | wc -l)
  [ "$formulas" -ge 20 ] || fail "$page has $formulas formulas, expected 20 or more"
  figures=$(grep -c '^!\[' "$handout" || true) inlined=$({ grep -o 'src="data:image/png' "$page" || true; } | wc -l)
  [ "$figures" = "$inlined" ] || fail "$page holds $inlined of $figures figures"
  for panel in $(sed -n 's/^<!-- explore: \([a-z]*\) -->$/\1/p' "$handout"); do
    grep -q "<div class=\"explore\" data-panel=\"$panel\"></div>" "$page" || fail "$page has no place for the panel $panel"
    grep -q "^const $panel = {" "$root/handouts/explore.js" || fail "$handout: explore.js has no panel $panel"
  done
  [ "$(grep -c '<div class="explore"' "$page")" = "$(grep -c '^<!-- explore: ' "$handout")" ] || fail "$page has other panels than $handout"
  grep -Eq '(^|> ?)##+ ' "$page" && fail "$page shows a heading as text: it wants an empty line before it"
  wide=$(awk '/^```/ { in_code = !in_code; next } in_code && length($0) > 122 { print FILENAME ":" NR }' "$handout")   # what a line of the PDF holds
  [ -z "$wide" ] || fail "code runs over the margin of the page: $wide"
  if grep -Eq '<(img|script|link)[^>]*(src|href)="(https?:)?//' "$page"; then fail "$page asks for something from the network"; fi
  loose=$({ grep -Eo '</math>[].,:;!?)][^ <]*(</span>)?' "$page" || true; } | grep -v '</span>$' | head -1 || true)
  [ -z "$loose" ] || fail "$page may break a line between a formula and what follows it: $loose"
  if grep -Eq '<code>[^<]*--[a-z]' "$page"; then fail "$page may break a line behind the hyphens of an option"; fi
  for anchor in $(grep -o '<a id="[^"]*"' "$handout" | cut -d'"' -f2); do
    grep -q "id=\"$anchor\"" "$page" || fail "$page has lost #$anchor"
  done
  [ "$(head -c 5 "$folder/out/$name.pdf")" = %PDF- ] || fail "$name.pdf is no PDF"
  cp "$folder/out/$name.pdf" "$folder/$name.first.pdf"
  grep -q "href=\"$name.pdf\"" "$folder/out/index.html" || fail "index.html does not link $name.pdf"
done

# The same handouts give the same bytes.
"$tumble" handouts --out "$folder/out" >"$folder/said" 2>&1
for first in "$folder"/*.first.pdf; do
  cmp "$first" "$folder/out/$(basename "$first" .first.pdf).pdf" || fail "a PDF changes from run to run"
done

# Faults are told with file and line, and nothing passes for built.
refused() {
  local code=0
  "$tumble" handouts --no-pdf --out "$folder/broken" >"$folder/said" 2>&1 || code=$?
  [ "$code" = 2 ] || fail "$1: exit $code, expected 2"
  grep -q "$2" "$folder/said" || { cat "$folder/said" >&2; fail "$1: the message does not say $2"; }
}
echo 'See [nothing](#no-such-place).' >>"$folder/tree/handouts/a1_impulse.md"
refused "a link to no place" "a1_impulse.md:$(wc -l <"$folder/tree/handouts/a1_impulse.md"): (#no-such-place)"
cp "$root/handouts/a1_impulse.md" "$folder/tree/handouts/"
rm "$folder/tree/handouts/figures/collide_off_centre_e05.png"
refused "a missing figure" "there is no figure collide_off_centre_e05.png"
echo "build_handouts: pages and PDFs of $(ls "$folder"/*.first.pdf | wc -l) handouts, as they should be"
