#!/usr/bin/env bash
# Whole submissions (solutions_private/attacks), graded as students hand them in: a sample, by default in the weaker kind of sandbox,
# which is where one would get through (the tests of tumble grade run in the strongest), in a whole run in each kind.
# All attacks: tumble attack --all
# Usage: hostile_submissions.sh TUMBLE
set -euo pipefail
[ -z "${TUMBLE_TEST_WHOLE:-}" ] || exec "$1" attack
code=0
"$1" attack --body landlock || code=$?
[ $code != 2 ] || exec "$1" attack   # it does not work on this machine
exit $code
