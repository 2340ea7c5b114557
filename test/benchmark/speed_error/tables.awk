# SPDX-License-Identifier: BSD-3-Clause
#
# awk -F, -f tables.awk speed_error.csv filter_ratio.csv > speed_error.md
# The two tables as a page to read.

FNR == 1 { ++file; set = ""; next }

file == 1 && NR == 2 {
  print "# Elementary tests: speed against error\n"
  print "Made by `cmake/speed_error.sh`; [the guide](../speed_error.md) explains it.\n"
  print "Machine: " $17 ".\n\n![Speed against error](speed_error.png)"
}

file == 1 && $1 != set {
  set = $1
  print "\n## " set ": " $4 " queries, " $5 " contacts\n"
  print "| method | setting | missed | invented | latest | earliest | mean ns " \
        "| median ns | 99.9% ns | exact |"
  print "|---|---|---|---|---|---|---|---|---|---|"
}
file == 1 {
  exact = $16 == "" ? "" : sprintf("%.2f%%", 100 * $16)
  print "| " $2 " | " $3 " | " $6 " | " $7 " | " $8 " | " $9 " | " $10 " | " $11 " | " \
        $12 " | " exact " |"
}

file == 2 && $1 != set {
  if (set == "") print "\n## Filters as stages"
  set = $1
  print "\n" set ", " $4 " queries:\n"
  print "| stage | setting | culled rightly | culled wrongly | of the plain filter's " \
        "| mean ns | cost / plain | additions | multiplications | divisions |"
  print "|---|---|---|---|---|---|---|---|---|---|"
}
file == 2 {
  share = sprintf("%.2f%%", 100 * $7)
  print "| " $2 " | " $3 " | " $5 " | " $6 " | " share " | " $8 " | " $9 " | " $10 " | " \
        $11 " | " $12 " |"
}
