# SPDX-License-Identifier: BSD-3-Clause
#
# awk -F, -f tables.awk speed.csv speed_baselines.csv speed_options.csv \
#     speed_sequence.csv > speed.md
# The tables as a page to read.

function heading(title) {
  print "\n## " title "\n"
  print "| scene | triangles | query | boxes | filter | kernels | threads | build | update " \
        "| traverse | test | total ms | ns / triangle | contacts | ns / contact | missed " \
        "| extra | MiB |"
  print "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
}

FNR == 1 { ++file; next }

!titled++ {
  print "# Speed of whole queries\n"
  print "Made by `cmake/speed.sh`; [the guide](../speed.md) explains it.\n"
  print "Machine: " $NF ".\n"
  print "| | |\n|---|---|"
  print "| ![Time and memory against size](speed_size.png) " \
        "| ![Stages of each scene](speed_stages.png) |"
  print "| ![Boxes and filters](speed_ablation.png) " \
        "| ![Tree quality over time](speed_sequence.png) |"
}

file == 1 {
  if (FNR == 2) heading("Scenes")
  print "| " $1 " | " $2 " | " $3 " | " $4 " | " $5 " | " $6 " | " $7 " | " $8 " | " $9 \
        " | " $10 " | " $11 " | " $12 " | " sprintf("%.0f", 1e6 * $12 / $2) " | " $13 \
        " | " ($3 == "all" && $13 ? sprintf("%.0f", 1e6 * $12 / $13) : "-") \
        " | " $14 " | " $15 " | " $17 " |"
}

file == 2 {
  if (FNR == 2) {
    print "\n## Methods of earlier papers\n"
    print "[What they are](../baselines.md). All contacts, one thread.\n"
    print "| scene | triangles | technique | filter | kernels | build | update | traverse " \
          "| test | total ms | triangle pairs | feature pairs | elementary tests " \
          "| contacts | missed | extra |"
    print "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
  }
  line = "|"
  for (i = 1; i <= 16; ++i) line = line " " $i " |"
  print line
}

file == 3 {
  if (FNR == 2) {
    print "\n## Options of a request\n"
    print "ms of the query without and with the option, one thread.\n"
    print "| scene | triangles | option | query | off | on | ratio | contacts | missed | extra |"
    print "|---|---|---|---|---|---|---|---|---|---|"
  }
  line = "|"
  for (i = 1; i <= 10; ++i) line = line " " $i " |"
  print line
}

# Sequences: the ratio of both trees' times, in four parts of each.
file == 4 {
  if (!($1 in steps)) order[++sequences] = $1
  ratio[$1, steps[$1]++] = $8
  if ($8 > worst[$1]) worst[$1] = $8
  restructured[$1] += $10
}

END {
  if (sequences == 0) exit
  print "\n## Tree of the first frame against a fresh one\n"
  print "Ratio of the times of an update with its query: mean over each quarter of the " \
        "sequence, and the worst step. Restructured: steps in which parts of the first " \
        "tree were made anew.\n"
  print "| sequence | steps | 1st | 2nd | 3rd | 4th | worst | restructured |"
  print "|---|---|---|---|---|---|---|---|"
  for (i = 1; i <= sequences; ++i) {
    line = "| " order[i] " | " steps[order[i]] " |"
    for (q = 0; q < 4; ++q) {
      sum = count = 0
      for (k = int(q * steps[order[i]] / 4); k < int((q + 1) * steps[order[i]] / 4); ++k) {
        sum += ratio[order[i], k]
        ++count
      }
      line = line " " (count ? sprintf("%.2f", sum / count) : "") " |"
    }
    print line sprintf(" %.2f | %d |", worst[order[i]], restructured[order[i]])
  }
}
