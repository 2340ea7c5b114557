# SPDX-License-Identifier: BSD-3-Clause
#
# gnuplot -e "folder='build/speed'" plot.gp
# Pictures from speed.csv and speed_sequence.csv, beside them: time and memory a triangle
# against size, stages of each scene, boxes and filters, tree quality over time. A picture
# whose rows are missing is left out.
set datafile separator ','
table = folder.'/speed.csv'
sequences = folder.'/speed_sequence.csv'
has(condition) = int(system("awk -F, '".condition." { n = 1 } END { print n + 0 }' '".table."'"))
set style line 1 lc rgb '#1d3557' pt 7 lw 1.5
set style line 2 lc rgb '#457b9d' pt 5 lw 1.5
set style line 3 lc rgb '#e63946' pt 9 lw 1.5
set grid y

if (has('$1 == "tiles"')) {
  rows(condition) = "< awk -F, '$1 == \"tiles\" && ".condition."' '".table."'"
  all = '$3 == "all" && $6 != "scalar"'
  first = '$3 == "first"'
  paper = '$6 == "scalar"'
  set terminal pngcairo size 1100, 420 font 'sans,11' background 'white'
  set output folder.'/speed_size.png'
  set multiplot layout 1, 2
  set logscale x
  set format x '10^{%T}'
  set xlabel 'triangles'
  set yrange [0:]
  set key bottom right
  set ylabel 'time [ns / triangle]'
  plot rows(all) using 2:(1e6 * $12 / $2) with linespoints ls 1 title 'all contacts', \
       rows(first) using 2:(1e6 * $12 / $2) with linespoints ls 2 title 'first contact', \
       rows(paper) using 2:(1e6 * $12 / $2) with linespoints ls 3 \
         title "all contacts, the paper's method"
  set key top right
  set ylabel 'peak memory, scene included [bytes / triangle]'
  plot rows(all) using 2:(1048576. * $17 / $2) with linespoints ls 1 title 'library', \
       rows(paper) using 2:(1048576. * $17 / $2) with linespoints ls 3 \
         title "the paper's method"
  unset multiplot
  unset logscale x
  set format x
  unset xlabel
}

if (has('$6 != "scalar" && NR > 1')) {
  # Bars for all and first contact; of the tiles only those nearest to a million.
  bars = "< awk -F, 'NR > 1 && $6 != \"scalar\" && $3 != \"any\" && ".\
         "($1 != \"tiles\" || ($2 > 5e5 && $2 < 2e6)) ".\
         "{ print $1 \" (\" $3 \"),\" $2 \",\" $9 \",\" $10 \",\" $11 }' '".table."'"
  set terminal pngcairo size 1100, 560 font 'sans,11' background 'white'
  set output folder.'/speed_stages.png'
  set style data histograms
  set style histogram rowstacked
  set style fill solid 0.9 noborder
  set boxwidth 0.7
  set xtics rotate by 40 right
  set key top right
  set yrange [0:]
  set ylabel 'time [ns / triangle]'
  plot bars using (1e6 * $3 / $2):xtic(1) lc rgb '#a8dadc' title 'update', \
       bars using (1e6 * $4 / $2) lc rgb '#457b9d' title 'traverse', \
       bars using (1e6 * $5 / $2) lc rgb '#1d3557' title 'test'
}

if (has('$5 == "none"')) {
  # A line a scene: name, then swept none, plain, certified, moving the same, library.
  bars = "< awk -F, '$3 == \"all\" { time[$1, $6 == \"scalar\" ? $4 $5 : \"library\"] = $12; ".\
         "if ($5 == \"none\" && !($1 in seen)) { seen[$1] = 1; name[++n] = $1 } } ".\
         "END { for (i = 1; i <= n; ++i) { s = name[i]; p = time[s, \"sweptplain\"]; ".\
         "print s \",\" time[s, \"sweptnone\"] / p \",\" 1 \",\" ".\
         "time[s, \"sweptcertified\"] / p \",\" time[s, \"movingnone\"] / p \",\" ".\
         "time[s, \"movingplain\"] / p \",\" time[s, \"movingcertified\"] / p \",\" ".\
         "time[s, \"library\"] / p } }' '".table."'"
  set terminal pngcairo size 1100, 480 font 'sans,11' background 'white'
  set output folder.'/speed_ablation.png'
  set style data histograms
  set style histogram clustered gap 1.5
  set style fill solid 0.9 noborder
  set boxwidth 1
  set xtics norotate center
  set key outside top center horizontal
  set yrange [0:*]
  set ylabel "all contacts: time / the paper's method"
  plot bars using 2:xtic(1) lc rgb '#f4b6b9' title 'swept, no filter', \
       bars using 3 lc rgb '#e63946' title 'swept, plain: the paper', \
       bars using 4 lc rgb '#a4161a' title 'swept, certified', \
       bars using 5 lc rgb '#cfe3ea' title 'moving, no filter', \
       bars using 6 lc rgb '#83b3c9' title 'moving, plain', \
       bars using 7 lc rgb '#457b9d' title 'moving, certified', \
       bars using 8 lc rgb '#1d3557' title 'library'
}

names = system("tail -n +2 '".sequences."' | cut -d, -f1 | uniq")
if (words(names) > 0) {
  set terminal pngcairo size 1100, 420 font 'sans,11' background 'white'
  set output folder.'/speed_sequence.png'
  set style data lines
  set xtics norotate center
  set key inside top left maxrows 1
  set xlabel 'frame'
  set yrange [0:*]
  set ylabel 'time of update and query: kept / fresh tree'
  plot for [i=1:words(names)] \
         "< grep '^".word(names, i).",' '".sequences."'" using 2:8 with lines ls i \
         title word(names, i), 1 with lines lc rgb '#bbbbbb' notitle
}
