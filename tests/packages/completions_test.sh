#!/usr/bin/env bash
# What each shell on this machine offers after "tumble ...": bash by its function, fish by what it says it would complete, zsh by typing
# into a terminal. A shell that is not here is left out, and said.
# Usage: completions_test.sh WORDS ROOT      WORDS: the folder that framework/packaging/make_words.sh wrote; ROOT: has assignments/
set -euo pipefail
words=$(cd "$1" && pwd)
export TUMBLE_COMPLETION_ROOT=$(cd "$2" && pwd)
fail() { echo "completions_test: $*" >&2; exit 1; }
empty=$(mktemp -d)
trap 'rm -rf "$empty"' EXIT
cd "$empty"   # files of a folder are offered too
printf '#!/bin/sh\n' >tumble && chmod +x tumble
export PATH=$empty:$PATH

bash -euc '
  source "$1/tumble.bash"
  complete_words() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _tumble; echo "${COMPREPLY[*]}"; }
  [ "$(complete_words tumble sta)" = start ]
  [[ "$(complete_words tumble check a)" == a1\ a2* ]]
  [[ "$(complete_words tumble run x --vi)" == *--video* ]]
' completion "$words" || fail "bash does not complete"

if command -v fish >/dev/null; then
  said=$(fish --no-config -c 'source $argv[1]/tumble.fish; for line in "tumble sta" "tumble check a" "tumble run --vi" "tumble run bouncing"; complete -C $line; end' "$words")
  for word in start a1 a2 --video bouncing_ball; do grep -q "^$word\b" <<<"$said" || fail "fish does not offer $word"; done
else
  echo "no fish here"
fi

if command -v zsh >/dev/null; then
  # Typed as a person does, each line with two tabs; what the terminal shows is read back. A busy machine needs longer waits.
  typed() {
    WORDS=$words PAUSE=$1 zsh -fc '
      zmodload zsh/zpty
      zpty shell "zsh -f -i"
      zpty -w shell "PROMPT=; fpath=($WORDS \$fpath); autoload -Uz compinit; compinit -u -D"
      sleep $((2 * PAUSE))
      for line in "tumble sta" "tumble check a" "tumble run --vide" "tumble run bouncing_b"; do
        zpty -w -n shell "$line"$'"'\\t\\t'"'
        sleep $PAUSE
        zpty -w -n shell $'"'\\x15'"'
      done
      zpty -w shell exit
      sleep $PAUSE
      while zpty -r shell line; do print -r -- "$line"; done' | cat -v
  }
  offers_all() {
    local word
    for word in 'tumble sta.*rt' 'a1 *a2' 'tumble run --vide.*o' 'bouncing_b.*all'; do grep -q -- "$word" <<<"$1" || return 1; done
  }
  offers_all "$(typed 1)" || offers_all "$(typed 3)" || offers_all "$(typed 9)" || fail "zsh does not complete"
else
  echo "no zsh here"
fi
echo "the shells complete the verbs, their options, assignments and scenes"
