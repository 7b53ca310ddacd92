#!/bin/sh
# Runs the attacks again as an ordinary user without any files, to test the sandbox without root. For root only (77: skipped);
# for other users the tests have already run that way.
#   as_ordinary_user.sh TEST_PROGRAM GOOGLETEST_FILTER
skip() { echo "skipped: $1"; exit 77; }
[ "$(id -u)" = 0 ] || skip "not root"
command -v setpriv >/dev/null || skip "no setpriv"
uid=58999
while getent passwd "$uid" >/dev/null; do uid=$((uid - 1)); done
as_user() { setpriv --reuid "$uid" --regid "$uid" --clear-groups --no-new-privs env -i PATH=/usr/bin:/bin HOME=/nonexistent ${TUMBLE_SANDBOX:+TUMBLE_SANDBOX="$TUMBLE_SANDBOX"} "$@"; }
as_user test -x "$1" || skip "an ordinary user cannot reach $1"
as_user "$1" --gtest_filter="$2" || exit 1
left=$(ps -o pid= -u "$uid")
[ -z "$left" ] || { echo "still running: $left"; exit 1; }
