# SPDX-License-Identifier: BSD-3-Clause
"""Succeeds if fcl_extension answers as fcl_ccd does: two plates meet at 0.35 of the step,
which is at none of the 10 times that stock FCL samples."""

import sys

import fcl_extension


def plate(half):
    a, b, c, d = (-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)
    return fcl_extension.Model([(a, b, c), (a, c, d)])


LARGE, SMALL = plate(1.0), plate(0.1)
TIME = fcl_extension.time_of_contact(LARGE, SMALL, (0.3, 0.2, 0.35), (0.3, 0.2, -0.65))
print(f"time of contact {TIME}")
sys.exit(0 if 0.35 - 2e-4 <= TIME <= 0.35 + 1e-12 else 1)
