# SPDX-License-Identifier: BSD-3-Clause
#
# awk -F, -v method=4 -v value=7 -v rows='iccd/none|iccd/plain' -f bars.awk table1.csv
# For clustered bars: a line a scene, which is the first column; its name, then the value
# of each row, named by the column `method` and the filter after it. Of rows of the same
# name the first, which is the scalar one.
FNR == 1 { next }
!($1 in seen) { seen[$1] = 1; scene[++scenes] = $1 }
!(($1, $method "/" $(method + 1)) in found) { found[$1, $method "/" $(method + 1)] = $value }
END {
  n = split(rows, row, "|")
  for (i = 1; i <= scenes; ++i) {
    line = scene[i]
    for (j = 1; j <= n; ++j) line = line "," found[scene[i], row[j]]
    print line
  }
}
