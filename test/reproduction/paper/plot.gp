# SPDX-License-Identifier: BSD-3-Clause
#
# gnuplot -e "folder='build/paper'; scripts='test/reproduction/paper'" plot.gp
# Pictures from the tables of the paper's experiments, beside them: time and culling of
# each scene, time and ratio over the frames. A picture without rows is left out.
set datafile separator ','
set terminal pngcairo size 1100, 420 font 'sans,11' background 'white'
set grid y
scenes(table) = system("tail -n +2 '".folder."/".table.".csv' | cut -d, -f1 | uniq")
bars(table, method, value, rows) = "< awk -F, -v method=".method." -v value=".value.\
  " -v rows='".rows."' -f '".scripts."/bars.awk' '".folder."/".table.".csv'"

set style data histograms
set style histogram clustered gap 1.5
set style fill solid 0.9 noborder
set boxwidth 1
set logscale y
set key outside right center vertical

set output folder.'/table1.png'
set ylabel 'time of a frame [ms]'
times = bars('table1', 4, 7, \
  'r-triangles/none|iccd/none|iccd/plain|ours/certified|ours (first)/certified')
plot times using 2:xtic(1) lc rgb '#a4161a' title 'r-triangles', \
     times using 3 lc rgb '#e63946' title 'iccd', \
     times using 4 lc rgb '#f4b6b9' title "iccd, plain filter: the paper's", \
     times using 5 lc rgb '#1d3557' title 'ours, all contacts', \
     times using 6 lc rgb '#83b3c9' title 'ours, first contact'

set output folder.'/figure8.png'
set ylabel 'elementary tests a frame'
set yrange [10:*]
tests = bars('figure8', 3, 5, \
  'r-triangles/none|r-triangles/plain|iccd/none|iccd/plain|ours/none|ours/plain|ours/certified')
plot tests using 2:xtic(1) lc rgb '#a4161a' title 'r-triangles', \
     tests using 3 lc rgb '#d9888b' title 'r-triangles, plain filter', \
     tests using 4 lc rgb '#e63946' title 'iccd', \
     tests using 5 lc rgb '#f4b6b9' title "iccd, plain filter: the paper's", \
     tests using 6 lc rgb '#83b3c9' title 'our boxes', \
     tests using 7 lc rgb '#457b9d' title 'our boxes, plain filter', \
     tests using 8 lc rgb '#1d3557' title 'ours'
unset logscale y

set style data lines
set xlabel 'frame'
set yrange [0:*]
if (words(scenes('figure9')) > 0) {
  rows(method, filter) = "< awk -F, '$3 == \"".method."\" && $4 == \"".filter."\"' '".\
    folder."/figure9.csv'"
  set output folder.'/figure9.png'
  set ylabel 'flamenco: time of a frame [ms]'
  plot rows('r-triangles', 'none') using 2:6 lc rgb '#a4161a' lw 2 title 'r-triangles', \
       rows('iccd', 'none') using 2:6 lc rgb '#e63946' lw 2 title 'iccd', \
       rows('iccd', 'plain') using 2:6 lc rgb '#f4b6b9' lw 2 \
         title "iccd, plain filter: the paper's", \
       rows('ours', 'certified') using 2:6 lc rgb '#1d3557' lw 2 \
         title 'ours, all contacts', \
       rows('ours (first)', 'certified') using 2:6 lc rgb '#83b3c9' lw 2 \
         title 'ours, first contact'
}

shown = scenes('figure10')
if (words(shown) > 0) {
  set output folder.'/figure10.png'
  set yrange [0:1]
  set multiplot layout 1, words(shown) margins 0.07, 0.985, 0.24, 0.92 spacing 0.045
  unset key
  do for [scene in shown] {
    if (scene eq word(shown, words(shown))) {
      set key at screen 0.5, 0.05 center maxrows 1
    }
    rows(boxes) = "< awk -F, '$1 == \"".scene."\" && $3 == \"".boxes."\"' '".folder.\
      "/figure10.csv'"
    set title scene
    set ylabel scene eq word(shown, 1) ? 'pairs that the filter culls' : ''
    plot rows('iccd') using 2:7 lc rgb '#e63946' lw 2 title "iccd's boxes, plain filter", \
         rows('ours') using 2:7 lc rgb '#1d3557' lw 2 title 'our boxes and filter'
  }
  unset multiplot
}
