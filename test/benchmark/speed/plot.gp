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
kernels = has('$6 == "vector"') ? 'vector' : 'scalar'
library = '$6 == "'.kernels.'" && $4 == "moving"'
set style line 1 lc rgb '#1d3557' pt 7 lw 1.5
set style line 2 lc rgb '#457b9d' pt 5 lw 1.5
set style line 3 lc rgb '#e63946' pt 9 lw 1.5
set style line 4 lc rgb '#a8dadc' pt 7 lw 1.5
set grid y

if (has('$1 == "tiles"')) {
  rows(condition) = "< awk -F, '$1 == \"tiles\" && ".condition."' '".table."'"
  all = '$3 == "all" && $7 == 1 && '.library
  first = '$3 == "first" && $7 == 1 && '.library
  threads = '$3 == "all" && $7 > 1 && '.library
  paper = '$6 ~ /paper/'
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
       rows(threads) using 2:(1e6 * $12 / $2) with linespoints ls 4 \
         title 'all contacts, all threads', \
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

if (has(library.' && $7 == 1')) {
  # Bars for all and first contact; of the tiles only those nearest to a million.
  bars = "< awk -F, '".library." && $7 == 1 && $3 != \"any\" && ".\
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
  # A line a scene: name, then the paper's method with swept boxes and filter none, plain,
  # certified, the same with moving boxes, and the library's rows.
  bars = "< awk -F, '$3 == \"all\" { ".\
         "time[$1, $6 ~ /paper/ ? $4 $5 : $6 $4 ($7 > 1 ? \"threads\" : \"\")] = $12; ".\
         "if ($5 == \"none\" && !($1 in seen)) { seen[$1] = 1; name[++n] = $1 } } ".\
         "END { k = split(\"sweptnone sweptplain sweptcertified movingnone movingplain ".\
         "movingcertified scalarswept scalarmoving vectorswept vectormoving ".\
         "vectormovingthreads\", what, \" \"); ".\
         "for (i = 1; i <= n; ++i) { s = name[i]; line = s; ".\
         "for (j = 1; j <= k; ++j) line = line \",\" ".\
         "((s, what[j]) in time ? time[s, what[j]] / time[s, \"sweptplain\"] : \"\"); ".\
         "print line } }' '".table."'"
  set terminal pngcairo size 1300, 480 font 'sans,11' background 'white'
  set output folder.'/speed_ablation.png'
  set style data histograms
  set style histogram clustered gap 1.5
  set style fill solid 0.9 noborder
  set boxwidth 1
  set xtics norotate center
  set key outside right center vertical
  set yrange [0:*]
  set ylabel "all contacts: time / the paper's method"
  plot bars using 2:xtic(1) lc rgb '#f4b6b9' title 'paper, no filter', \
       bars using 3 lc rgb '#e63946' title 'paper', \
       bars using 4 lc rgb '#a4161a' title 'paper, certified', \
       bars using 5 lc rgb '#cfe3ea' title 'paper, moving, no filter', \
       bars using 6 lc rgb '#83b3c9' title 'paper, moving', \
       bars using 7 lc rgb '#457b9d' title 'paper, moving, certified', \
       bars using 8 lc rgb '#f2e2b3' title 'library, swept, scalar', \
       bars using 9 lc rgb '#e0b24c' title 'library, scalar', \
       bars using 10 lc rgb '#b7c4a8' title 'library, swept', \
       bars using 11 lc rgb '#1d3557' title 'library', \
       bars using 12 lc rgb '#000000' title 'library, all threads'
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
