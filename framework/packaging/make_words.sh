#!/usr/bin/env bash
# Makes the manual page and the completions of the shells from what the verbs say of themselves, framework/cli/help/*.txt (which
# tests/cli/help_files.sh holds equal to the program).
# Usage: make_words.sh HELP FOLDER VERSION      writes FOLDER/tumble.1, tumble.bash, _tumble (zsh), tumble.fish
set -euo pipefail
help=$1 out=$2 version=$3
mkdir -p "$out"
verbs=$(sed -n '/^Verbs:/,$p' "$help/tumble.txt" | awk '/^  [a-z]/ { print $1 }')
# What a verb does: the lines before its usage.
title() { awk '/^Usage: / { exit } { printf "%s%s", between, $0; between = " " } END { print "" }' "$help/$1.txt"; }
# The long options of a verb, one a line.
options() { awk '/^Options:/ { on = 1; next } /^[^ ]/ { on = 0 } on && /^  -/ { n = split($1, names, ","); print names[n] }' "$help/$1.txt"; }
# What the first positional word of a verb is: assignment, scene, or nothing known.
first_word() { awk '/^Positionals:/ { getline; print $1; exit }' "$help/$1.txt"; }

man_page() {
  printf '.\\" Made from the words of the verbs.\n.TH TUMBLE 1 "" "Tumble %s" "Tumble"\n.SH NAME\n' "$version"
  printf 'tumble \\- a course on rigid-body simulation that grades itself\n'
  printf '.SH SYNOPSIS\n.B tumble\n.I VERB\n[words and options of the verb]\n.SH VERBS\n'
  local verb
  for verb in $verbs; do
    awk '
      function plain(text) { gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text); sub(/^[.\x27]/, "\\\\\\&&", text); return text }
      # A word of 28 columns, then what it is; a long word has its explanation in the next line.
      function entry(line,    word) {
        word = substr(line, 3, 28); sub(/ .*/, "", word)
        if (match(substr(line, 3), /  +/)) { word = substr(line, 3, RSTART - 1); line = substr(line, 2 + RSTART + RLENGTH) }
        else if (length(line) > 30 && substr(line, 30, 1) == " ") { word = substr(line, 3, 27); line = substr(line, 31) }
        else { word = substr(line, 3); line = "" }
        print ".TP\n.B " plain(word); if (line != "") print plain(line)
      }
      !begun && !/^Usage: / { next }
      /^Usage: / { begun = 1; print ".SS " plain(substr($0, 8)); print plain(title); next }
      /^Positionals:|^Options:/ { inside = 1; next }
      /^  -h,--help|^  --help-all/ { next }
      inside && /^  [^ ]/ { entry($0); next }
      inside && /^   / { sub(/^ +/, ""); print plain($0); next }
      /^$/ { inside = 0; next }
      /^    / { sub(/^ +/, ""); print plain($0); next }   # goes on with the line above it
      { sub(/^ +/, ""); print (after++ ? ".br" : ".PP"); print plain($0) }
    ' title="$(title "$verb")" "$help/$verb.txt"
  done
  printf '.SH FILES\n.TP\n.I /usr/share/tumble\nhandouts, headers, models, scenes, public tests\n'
}

bash_words() {
  cat <<'END'
# Completion of tumble in bash, made from the words of the verbs.
_tumble_names() {   # KIND: the names of assignments or scenes
  local folder root=${TUMBLE_COMPLETION_ROOT:-/usr/share/tumble}
  case $1 in
    assignment) for folder in "$root"/assignments/a[0-9]*_*/; do folder=${folder%/}; folder=${folder##*/}; echo "${folder%%_*}"; done ;;
    scene) for folder in "$root"/assignments/*/scenes/*.json; do folder=${folder##*/}; echo "${folder%.json}"; done ;;
  esac
}
_tumble() {
  local word=${COMP_WORDS[COMP_CWORD]} verb=${COMP_WORDS[1]} options='' first=''
  COMPREPLY=()
END
  printf "  if [ \"\$COMP_CWORD\" = 1 ]; then\n    mapfile -t COMPREPLY < <(compgen -W '%s --help --version' -- \"\$word\")\n    return\n  fi\n  case \$verb in\n" "$(xargs <<<"$verbs")"
  local verb
  for verb in $verbs; do
    printf "    %s) options='%s' first='%s' ;;\n" "$verb" "$(options "$verb" | xargs)" "$(first_word "$verb")"
  done
  cat <<'END'
  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [ "$COMP_CWORD" = 2 ] && [ -n "$(_tumble_names "$first")" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_tumble_names "$first")" -- "$word"; compgen -f -- "$word")
  fi
}
complete -o default -F _tumble tumble
END
}

# One word in single quotes, for zsh and fish.
quoted() { sed "s/'/'\\\\''/g; s/^/'/; s/\$/'/" <<<"$1"; }

zsh_words() {
  printf '#compdef tumble\n# Completion of tumble in zsh, made from the words of the verbs.\n'
  cat <<'END'
local root=${TUMBLE_COMPLETION_ROOT:-/usr/share/tumble} first=''
local -a verbs options names folders
END
  echo 'verbs=('
  local verb
  for verb in $verbs; do printf '  %s\n' "$(quoted "$verb:$(title "$verb" | sed 's/:/\\:/g')")"; done
  printf ')\ncase $words[2] in\n'
  for verb in $verbs; do
    printf "  %s) options=(%s) first='%s' ;;\n" "$verb" "$(options "$verb" | xargs)" "$(first_word "$verb")"
  done
  cat <<'END'
esac
case $first in
  assignment) folders=($root/assignments/a[0-9]*_*(N/:t)) names=(${folders%%_*}) ;;
  scene) names=($root/assignments/*/scenes/*.json(N:t:r)) ;;
esac
if (( CURRENT == 2 )); then
  _describe verb verbs
elif [[ $PREFIX == -* ]]; then
  compadd -- $options
elif (( CURRENT == 3 && $#names > 0 )); then
  compadd -- $names
  _files
else
  _files
fi
END
}

fish_words() {
  cat <<'END'
# Completion of tumble in fish, made from the words of the verbs.
function __tumble_names   # KIND: the names of assignments or scenes
    set -l root /usr/share/tumble
    set -q TUMBLE_COMPLETION_ROOT; and set root $TUMBLE_COMPLETION_ROOT
    switch $argv[1]
        case assignment
            for folder in $root/assignments/a*_*/
                string replace -r '_.*' '' (basename $folder)
            end
        case scene
            for file in $root/assignments/*/scenes/*.json
                basename $file .json
            end
    end
end
function __tumble_first_word_of   # VERB: whether the word that comes is the first one after it
    set -l words (commandline -opc)
    test (count $words) = 2; and test $words[2] = $argv[1]
end
END
  local verb option first
  for verb in $verbs; do
    printf "complete -c tumble -n __fish_use_subcommand -a %s -d '%s'\n" "$verb" "$(title "$verb" | sed "s/'/\\\\'/g")"
    first=$(first_word "$verb")
    case $first in
      assignment | scene) printf "complete -c tumble -n '__tumble_first_word_of %s' -a '(__tumble_names %s)'\n" "$verb" "$first" ;;
    esac
    for option in $(options "$verb"); do
      printf "complete -c tumble -n '__fish_seen_subcommand_from %s' -l %s\n" "$verb" "${option#--}"
    done
  done
}

man_page >"$out/tumble.1"
gzip -9nc "$out/tumble.1" >"$out/tumble.1.gz"
bash_words >"$out/tumble.bash"
zsh_words >"$out/_tumble"
fish_words >"$out/tumble.fish"
