#!/usr/bin/env bash
# A compiler launcher for the released tree: takes an object that the main build has made already where a compiler would make the same one again,
# that is where the command is the same but for the trees' paths, and all that it reads is the same, byte for byte. Else it compiles.
# Prepared by release_builds.sh, which says by these variables where things lie:
#   TUMBLE_RELEASED   the released tree, built in its folder `build`
#   TUMBLE_MAIN, TUMBLE_MAIN_BUILD   the main tree and its build
#   TUMBLE_SHARED     a folder of notes: `commands` and `deps` of the main build, `outdated` (what it would
#                     make anew), `same` (the files that both trees have alike), `log`
set -euo pipefail

# In words of the main tree.
as_main() { local text=${1//"$TUMBLE_RELEASED/build"/"$TUMBLE_MAIN_BUILD"}; printf '%s' "${text//"$TUMBLE_RELEASED"/"$TUMBLE_MAIN"}"; }

# The compiler's words after its name, as the shell would be given them: quotes mean the same on both sides, so they are dropped.
words_of() { printf '%s' "$1" | tr -d "\"\\\\'" | sed 's/^.*c++ //; s/ && :$//'; }

# Whether the main build made `object` by this command out of files that the released tree has alike.
is_shared() {
  local object=$1 command=$2 word file
  for word in "${@:3}"; do case $word in -D*"$TUMBLE_RELEASED"*) return 1 ;; esac; done   # a path that the object itself would hold
  [ -f "$TUMBLE_MAIN_BUILD/$object" ] || return 1
  ! grep -qF -- " $object" "$TUMBLE_SHARED/outdated" || return 1
  [ "$(words_of "$(grep -F -- " -o $object " "$TUMBLE_SHARED/commands")")" = "$(as_main "$(words_of "$command")")" ] || return 1
  awk -v object="$object:" '$1 == object { found = 1; next } found && /^ / { print $1; next } found { exit }' "$TUMBLE_SHARED/deps" >"$TUMBLE_SHARED/read.$$"
  [ -s "$TUMBLE_SHARED/read.$$" ] || return 1
  local same=$'\n'$(<"$TUMBLE_SHARED/same")$'\n'   # asked without another process: an object reads a hundred files
  while read -r file; do
    case $file in
      /usr/*) ;;
      "$TUMBLE_MAIN_BUILD"/* | [!/]*)   # made by the build: the same but for the trees' paths
        file=${file#"$TUMBLE_MAIN_BUILD/"}
        [ -f "$file" ] || return 1
        case $file in *.gch) continue ;; esac   # shared by this script as well, or no object that uses it is
        [ "$(as_main "$(<"$file")")" = "$(<"$TUMBLE_MAIN_BUILD/$file")" ] || return 1 ;;
      *) file=${file#"$TUMBLE_MAIN/"}
         case $same in *$'\n'"$file"$'\n'*) ;; *) return 1 ;; esac
         case $file in assignments/*) cmp -s "$TUMBLE_RELEASED/$file" "$TUMBLE_MAIN/$file" || return 1 ;; esac ;;   # a student may have worked on it since
    esac
  done <"$TUMBLE_SHARED/read.$$"
}

object='' depfile='' previous=''
for word; do
  case $previous in -o) object=$word ;; -MF) depfile=$word ;; esac
  previous=$word
done
if is_shared "$object" "$*" "$@"; then
  cp "$TUMBLE_MAIN_BUILD/$object" "$object"
  { printf '%s:' "$object"
    # the build's folder may lie in the main tree, and the released one in the build's: each path is turned once
    sed -e "s#^$TUMBLE_MAIN_BUILD/#$TUMBLE_RELEASED/build/#" -e t -e "s#^$TUMBLE_MAIN/#$TUMBLE_RELEASED/#" "$TUMBLE_SHARED/read.$$" | sed 's/^/ \\\n  /'
    printf '\n'; } >"$depfile"
  rm -f "$TUMBLE_SHARED/read.$$"
  echo "shared $object" >>"$TUMBLE_SHARED/log"
else
  rm -f "$TUMBLE_SHARED/read.$$"
  echo "compiled $object" >>"$TUMBLE_SHARED/log"
  exec "$@"
fi
