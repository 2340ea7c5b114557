# SPDX-License-Identifier: BSD-3-Clause
#
# gnuplot -e "table='motions.csv'; picture='motions.png'" plot.gp
# A panel for each scene; a point for each method and kind of motion.
set datafile separator ','
scenes = "random grazing"
methods = system("tail -n +2 '".table."' | cut -d, -f3 | awk '!seen[$0]++'")

set terminal pngcairo size 940, 480 font 'sans,11' background 'white'
set output picture
set logscale xy
set grid
set xlabel 'median time of a query [ms]'
set xtics (0.001, 0.01, 0.1, 1, 10, 100, 1000)

# Nothing wrong is drawn on the lowest line, which a logarithmic axis would hide.
least = 1e-3
rate(s, m) = strcol(1) eq s && strcol(3) eq m \
  ? (column(6) + column(7) + column(8) > 0 \
     ? (column(6) + column(7) + column(8)) / column(4) : least) : NaN

set multiplot layout 1, 2 margins 0.08, 0.985, 0.24, 0.93 spacing 0.06, 0
unset key
set yrange [least / 2 : 2]
set ytics ('none' least, 1e-2, '0.1' 0.1, '1' 1)
do for [s in scenes] {
  set title s
  set ylabel s eq word(scenes, 1) ? '(missed + late + false) / queries' : ''
  if (s eq word(scenes, 2)) { set key at screen 0.5, 0.06 center maxrows 2 samplen 1 }
  plot for [i=1:words(methods)] table skip 1 using 12:(rate(s, word(methods, i))) \
    with points lc i pt i + 3 ps 1.2 lw 1.5 title word(methods, i)
}
unset multiplot
