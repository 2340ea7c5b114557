# SPDX-License-Identifier: BSD-3-Clause
#
# awk -F, -f tables.awk motions.csv > motions.md
# The table as a page to read.

NR == 1 {
  print "# Meshes that turn: speed and errors\n"
  print "Made by `cmake/motions.sh`; [the guide](../numerics.md#speed-and-errors) explains it.\n"
  next
}

NR == 2 {
  print "Machine: " $NF ". One thread.\n"
  print "![Wrong answers against time](motions.png)\n"
  print "| scene | motion | method | queries | contacts | missed | late | false | early " \
        "| max early | max late | median ms | 99% ms |"
  print "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
}

{
  line = "|"
  for (i = 1; i <= 13; ++i) line = line " " $i " |"
  print line
}
