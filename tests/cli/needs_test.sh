#!/usr/bin/env bash
# framework/cli/needs.txt, by which ./tumble decides what to build, is about the verbs that there are: each stands in it once, its program
# knows it, and the build knows its targets.
# Usage: needs_test.sh ROOT BUILD
set -euo pipefail
root=$1 build=$2
export TUMBLE_ROOT=$root
fail() { echo "needs_test: $*" >&2; exit 1; }
verbs=$("$build/bin/tumble" --help | sed -n '/^Verbs:/,$p' | awk '/^  [a-z]/ { print $1 }')
rows=$(grep -v '^#' "$root/framework/cli/needs.txt")
[ "$(sort <<<"$verbs")" = "$(awk '{ print $1 }' <<<"$rows" | sort)" ] || fail "the verbs of the table are not those of the program"

ids() { for folder in "$root/$1"/a[0-9]*_*/; do [ -d "$folder" ] && basename "$folder" | sed 's/_.*//'; done; }
known=$(ninja -C "$build" -t targets all | sed 's/: [A-Za-z_]*$//')
while read -r verb program audience targets; do
  [ "$("$build/bin/$program" "$verb" --help)" = "$(cat "$root/framework/cli/help/$verb.txt")" ] || fail "$program does not say of $verb what its help says"
  case $audience in everyone) ;; instructor) [ -d "$root/solutions_private" ] || continue ;; *) fail "$verb: for whom is '$audience'?" ;; esac
  for target in $program $targets; do
    case $target in solutions:*) [ -d "$root/solutions_private" ] || continue ;; esac
    case $target in first:*)
      for id in $(awk '{ print $1 }' "$build/first_checks.txt"); do
        name=${target#first:} name=${name//\{id\}/$id}
        grep -qx -- "$name" <<<"$known" || fail "$verb: the build has no target $name"
      done
      continue ;;
    esac
    target=${target#file:} target=${target#mytests:} target=${target#solutions:}
    for id in $(case $target in *solved*) ids solutions_private ;; *) ids assignments ;; esac); do
      name=$(sed "s/{[a-z]*}/$id/" <<<"$target")
      grep -qx -- "$name" <<<"$known" || fail "$verb: the build has no target $name"
    done
  done
done <<<"$rows"
echo "every verb has its program, and every target that it asks for is there"
