#!/bin/sh
# The installed command: the grader's program for those who may read it, else the course's.
here=$(dirname "$(readlink -f "$0")")
for program in "$here/../../opt/tumble-grader/bin/tumble" "$here/../lib/tumble/bin/tumble"; do
  [ -x "$program" ] && exec "$program" "$@"
done
echo "tumble: its programs are not where the package puts them. Install tumble-course again." >&2
exit 2
