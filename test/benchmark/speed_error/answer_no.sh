#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The least outside solver: reads the query file and answers no to everything.
#   fcl_ccd_speed_error OUT --solver no=test/benchmark/speed_error/answer_no.sh
exec awk -F, '!/^#/ { print $1 ",0," }' "$1"
