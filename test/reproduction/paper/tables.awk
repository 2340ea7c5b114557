# SPDX-License-Identifier: BSD-3-Clause
#
# awk -F, -v kind=KIND -v prefix=PREFIX -f tables.awk paper_scenes.csv paper_frames.csv table1.csv
#   figure6.csv figure8.csv figure9.csv figure10.csv filter.csv paper_topologies.csv > paper.md
# The tables as a page to read, the paper's figures beside ours.

BEGIN {
  # Table 1 and section 4.2 of the paper.
  paper("cloth", 144, 2, 2.4, 11.5)
  paper("princess", 18.7, 2.4, 3.1, 20.5)
  paper("flamenco", 110, 1.5, 2.8, 17)
  paper("balls", 52.8, 1.7, 3.4, 17)
  paper("alphabets", 4.6, 3.5, 8.2, 58)
  paper("lion", 4432, 2.4, 4.1, 10)
}

function paper(scene, ms, over_iccd, over_rtriangles, reduction) {
  paper_ms[scene] = ms
  paper_iccd[scene] = over_iccd
  paper_rtriangles[scene] = over_rtriangles
  paper_reduction[scene] = reduction
}

function heading(title, text, columns,   n, i, rule) {
  print "\n## " title "\n\n" text "\n\n| " columns " |"
  n = split(columns, parts, "|")
  for (i = 1; i <= n; ++i) rule = rule "|---"
  print rule "|"
}

# Fields from the first to the last, of this row.
function row(first, last,   i, line) {
  for (i = first; i <= last; ++i) line = line "| " $i " "
  return line "|"
}

function percent(share) { return share == "-" ? share : sprintf("%.0f%%", 100 * share) }

FNR == 1 {
  # Of the motions that were proposed.
  if (file == "paper_frames" && kind == "proposed") printFrames()
  if (file == "table1") printTable1()
  file = FILENAME
  sub(/.*\//, "", file)
  sub(/\.csv$/, "", file)
  next
}

file == "paper_scenes" {
  if (FNR == 2) {
    print "# The paper's experiments, run again: " kind " frames\n"
    print "Made by `cmake/paper.sh`; [the guide](../reproduction.md) explains it.\n"
    print "Machine: " $9 ". One thread."
    heading("Scenes", "Frames measured, each `every`-th; contacts of a frame, mean.",
            "scene | triangles of the paper's | triangles | vertices | frames | every " \
            "| contacts | contacts a triangle")
  }
  print row(1, 8)
}

file == "paper_frames" {
  if (!($1 in frames)) simulated[++simulations] = $1
  ++frames[$1]
  density[$1] += $10
  if ($10 > densest[$1]) densest[$1] = $10
  dense[$1] += $10 >= 1
  turnover[$1] += ($11 + $12) / 2
  met[$1] += $8 + $9
  crossings[$1] += $13
  seconds[$1] += $17
}

function printFrames(   i, s) {
  heading("Contacts over the frames",
          "All frames of the simulation (paper_frames.csv): contacts a triangle, contacts " \
          "that were none in the frame before or are none in the next one, queries of " \
          "the simulator that met surfaces which cross, and what it needed.",
          "scene | frames | mean | most | frames with at least 1 | started or ended in a " \
          "frame | crossings | seconds")
  for (i = 1; i <= simulations; ++i) {
    s = simulated[i]
    printf "| %s | %d | %.2f | %.2f | %d | %.0f%% | %d | %.0f |\n", s, frames[s],
           density[s] / frames[s], densest[s], dense[s], 100 * turnover[s] / met[s],
           crossings[s], seconds[s]
  }
}

# Kept for two tables.
file == "table1" {
  all[++rows] = row(1, 12)
  if (!($1 in seen)) { seen[$1] = 1; scene[++scenes] = $1 }
  key = $1 SUBSEP $4 "/" $5 ($4 ~ /^ours/ ? "" : "/" $6)
  ms[key] = $7
  over_iccd[key] = $8
  over_rtriangles[key] = $9
  errors[key] = $11 " / " $12
}

function figures(s, method) {
  return ms[s, method] " | " over_iccd[s, method] " | " over_rtriangles[s, method] " | " \
         errors[s, method]
}

function printTable1(   i, s, first) {
  heading("Table 1, the paper's beside ours",
          "Paper: its method on its machine. Iccd, plain filter, scalar: its method here. " \
          "Speedups over ICCD and over R-Triangles, both scalar and without a filter. " \
          "Errors: missed / extra, of the frames measured; of the first contact, frames with " \
          "another time than that of all contacts.",
          "scene | paper: ms | over iccd | over r-triangles | its method here: ms " \
          "| over iccd | over r-triangles | errors | ours, all contacts: ms | over iccd " \
          "| over r-triangles | errors | ours, first contact: ms | over iccd " \
          "| over r-triangles | errors | ms / paper's ms")
  for (i = 1; i <= scenes; ++i) {
    s = scene[i]
    first = "ours (first)/certified"
    print "| " s " | " paper_ms[s] " | " paper_iccd[s] " | " paper_rtriangles[s] " | " \
          figures(s, "iccd/plain/scalar") " | " figures(s, "ours/certified") " | " \
          figures(s, first) " | " sprintf("%.2f", ms[s, first] / paper_ms[s]) " |"
  }
  heading("Table 1, all methods",
          "ms of a frame (update, traversal, tests), and elementary tests, mean over " \
          "the frames; errors added up. ![Time of a frame](" prefix "table1.png)",
          "scene | triangles | frames | method | filter | kernels | query ms | over iccd " \
          "| over r-triangles | elementary tests | missed | extra")
  for (i = 1; i <= rows; ++i) print all[i]
}

file == "figure6" {
  if (FNR == 2)
    heading("Figure 6, edges of edge-edge tests",
            "In frame " $2 " of " $1 ": the pairs of edges that the solver is asked, and " \
            "their edges. ![Edges of edge-edge tests](" prefix "figure6.png)",
            "culling | pairs of edges | edges | share of pairs")
  print "| " $3 " | " $4 " | " $5 " | " percent($6) " |"
}

file == "figure8" {
  if (FNR == 2)
    heading("Figure 8, elementary tests",
            "A frame, mean. Reduction: from the same boxes without a filter; from " \
            "R-Triangles without a filter. ![Elementary tests](" prefix "figure8.png)",
            "scene | boxes | filter | elementary tests | reduction | paper's reduction " \
            "| from r-triangles | missed | extra")
  print "| " $1 " | " $3 " | " $4 " | " $5 " | " $6 " | " \
        ($3 != "ours" && $4 == "plain" ? paper_reduction[$1] : "") " | " $7 " | " $8 \
        " | " $9 " |"
}

file == "figure9" {
  if (FNR == 2) figure9 = $1
  key = $3 ", " $4 " filter"
  if (!(key in frames9)) curve[++curves] = key
  ++frames9[key]
  sum9[key] += $6
  if ($6 > most9[key]) most9[key] = $6
  errors9[key] += $7 + $8
}

file == "figure10" {
  key = $1 " | " $3 " | " $4
  if (!(key in frames10)) { ratio[++ratios] = key; least10[key] = 1 }
  if ($7 == "-") next
  ++frames10[key]
  sum10[key] += $7
  if ($7 < least10[key]) least10[key] = $7
  if ($7 > most10[key]) most10[key] = $7
  above10[key] += $7 > 0.8
}

file == "filter" { filter[++filters] = row(1, 16) }

# Filters change nothing about them.
file == "paper_topologies" && ($3 == "none" || $2 == "ours") {
  topologies[++num_topologies] = "| " $1 " | " $2 " | " $4 " | " $5 " | " $6 " |"
}

END {
  if (curves > 0)
    heading("Figure 9, time over the frames of " figure9,
            "ms of a frame. ![Time over the frames](" prefix "figure9.png)",
            "method | frames | mean | most | errors")
  for (i = 1; i <= curves; ++i) {
    key = curve[i]
    printf "| %s | %d | %.2f | %.2f | %d |\n", key, frames9[key],
           sum9[key] / frames9[key], most9[key], errors9[key]
  }
  if (ratios > 0)
    heading("Figure 10, pairs without penetration",
            "Share of the pairs of features that the filter culls, over the frames. The " \
            "paper's \"tend to be above 80%\". ![Pairs without penetration](" prefix "figure10.png)",
            "scene | boxes | filter | least | mean | most | frames above 80%")
  for (i = 1; i <= ratios; ++i) {
    key = ratio[i]
    if (frames10[key])
      print "| " key " | " percent(least10[key]) " | " \
            percent(sum10[key] / frames10[key]) " | " percent(most10[key]) " | " \
            above10[key] " of " frames10[key] " |"
  }
  if (filters > 0)
    heading("The filter and Interval-Newton",
            "On pairs drawn evenly from those whose swept boxes overlap; `left`: on those " \
            "that the filter leaves. The paper's: 29 additions and 40 multiplications " \
            "against 155, 217 and 6 divisions; 5.5 to 10.2 times.",
            "scene | pairs | filter ns | Newton ns | times | left | Newton ns | times " \
            "| filter + | filter * | Newton + | Newton * | Newton / | filter missed " \
            "| Newton missed | Newton extra")
  for (i = 1; i <= filters; ++i) print filter[i]
  if (num_topologies > 0)
    heading("Structures",
            "Topologies that a method took in, the first one included, and ms for each, " \
            "mean: trees and what else depends on the topology. Not in the times above.",
            "scene | method | kernels | topologies | ms")
  for (i = 1; i <= num_topologies; ++i) print topologies[i]
}
