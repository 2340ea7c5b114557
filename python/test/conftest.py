# SPDX-License-Identifier: BSD-3-Clause
"""Tests find scenes.py and reference.py beside them."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
