#!/usr/bin/env bash
# The build script of the exercise, in the working folder: reads assignment/, writes results/*.xml and
# customFeedbacks/*.json. Nothing about hidden tests is printed: students may read build logs.
set -u
rm -rf results customFeedbacks
exec "${TUMBLE:-tumble}" autograde @id@ "${TUMBLE_SUBMISSION:-assignment}" --for artemis --out .
