#!/usr/bin/env bash
# Usage: check_report.sh FOLDER [N]   N: of `./tumble demo --scenes N`
# Looks at what `./tumble demo` left: the scores that are known beforehand, a picture and a video of every demo scene with
# something on them, and no link that leads nowhere.
set -euo pipefail
shopt -s globstar nullglob
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
demo=${1:?which folder?}
first=${2:-1000}
faults=0
fault() { echo "check_report: $*" >&2; faults=$((faults + 1)); }

[ -s "$demo/index.html" ] || { fault "$demo/index.html is missing"; exit 1; }

scores=0
# Scores: the reference has them all, the untouched starter none, the flawed submission some.
for folder in "$root"/assignments/a[0-9]*_*/; do
  assignment=$(basename "$folder") assignment=${assignment%%_*}
  book=$demo/$assignment/gradebook.csv
  [ -s "$book" ] || { fault "$book is missing"; continue; }
  scores=$((scores + $(grep -c . "$book") - 2))   # two lines of headings
  score() { awk -F, -v who="$1" '{ gsub(/"/, "") } $1 == who { print $NF }' "$book"; }
  for expected in "reference == 100" "starter == 0" "flawed > 0" "flawed < 100"; do
    read -r who test bound <<<"$expected"
    found=$(score "$who")
    awk -v found="${found:-nothing}" -v bound="$bound" -v test="$test" \
      'BEGIN { x = found + 0; exit !(found ~ /^[0-9.]+$/ && ((test == "==" && x == bound) || (test == ">" && x > bound) || (test == "<" && x < bound))) }' ||
      fault "$book: $who of $assignment has ${found:-no score}, expected $test $bound"
  done
  grep -q '<a ' "$demo/$assignment/index.html" || fault "$demo/$assignment/index.html lists no submission"
done

# Pictures and videos. A picture of one colour deflates to less than 1 kB, the barest scene to 20.
scenes=0
while IFS= read -r scene; do
  name=$(basename "$scene" .json)
  scenes=$((scenes + 1))
  folder=$(basename "$(dirname "$(dirname "$scene")")")
  assignment=${folder%%_*}
  media=$demo/$assignment/flawed/media
  picture=$media/$name.png video=$media/$name.mp4
  [ "$(stat -c %s "$picture" 2>/dev/null || echo 0)" -gt 8000 ] || fault "$picture is missing or empty"
  seconds=$(ffprobe -v error -show_entries format=duration -of csv=p=0 "$video" 2>/dev/null || echo 0)
  awk -v s="${seconds:-0}" 'BEGIN { exit !(s >= 1) }' || fault "$video is missing or shorter than a second"
  grep -q "/$name.png" "$demo/index.html" || fault "$demo/index.html does not show $name"
  grep -q "/$name.html" "$demo/index.html" || fault "$demo/index.html does not link the page that plays $name"
done < <(for folder in "$root"/assignments/*/scenes; do printf '%s\n' "$folder"/*.json | LC_ALL=C sort | head -n "$first"; done)
[ "$scenes" -ge 10 ] || fault "only $scenes scenes under $root/assignments"

# Links stay in the report and lead somewhere.
links=0
for page in "$demo"/**/*.html; do
  while IFS= read -r link; do
    case $link in '' | \#*) continue ;; http:* | https:* | //*) fault "$page: link to the network: $link"; continue ;; data:*) continue ;; esac
    links=$((links + 1))
    path=${link%%#*}
    printf -v path '%b' "${path//%/\\x}"
    [ -e "$(dirname "$page")/$path" ] || fault "$page: $link leads nowhere"
  done < <(grep -Eo '(src|href|poster)="[^"]*"' "$page" | sed -E 's/^[a-z]+="//; s/"$//')
done

[ "$faults" = 0 ] || { echo "check_report: $faults faults in $demo" >&2; exit 1; }
echo "check_report: scores of $scores submissions, pictures and videos of $scenes scenes, $links links: all as they should be"
