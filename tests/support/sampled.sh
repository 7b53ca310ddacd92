#!/bin/sh
# Runs tests by GoogleTest's filter, or all of them in a whole run (./tumble test --whole).
# Usage: sampled.sh FILTER COMMAND...   COMMAND ends with the program of the tests
filter=$1
shift
[ -n "${TUMBLE_TEST_WHOLE:-}" ] && exec "$@"
exec "$@" --gtest_filter="$filter"
