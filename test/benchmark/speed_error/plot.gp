# SPDX-License-Identifier: BSD-3-Clause
#
# gnuplot -e "table='speed_error.csv'; picture='speed_error.png'" plot.gp
# A column of panels for each set of queries; a curve for each method, a point for each of
# its settings.
set datafile separator ','
sets = system("tail -n +2 '".table."' | cut -d, -f1 | uniq")
methods = system("tail -n +2 '".table."' | cut -d, -f2 | awk '!seen[$0]++'")
columns = words(sets)

set terminal pngcairo size 100 + 340 * columns, 860 font 'sans,11' background 'white'
set output picture
set logscale xy
set grid
set xlabel 'mean time of a query [ns]'
set format y '%.0e'
set linetype 5 lc rgb '#d02020'
set xtics ('10' 10, '100' 100, '1e3' 1e3, '1e4' 1e4, '1e5' 1e5, '1e6' 1e6, '1e7' 1e7)

# Nothing wrong is drawn on the lowest line, which a logarithmic axis would hide.
least_rate = 1e-7
least_time = 1e-17
atLeast(x, least) = x > least ? x : least
larger(x, y) = x > y ? x : y
isRow(s, m) = strcol(1) eq s && strcol(2) eq m
rate(s, m) = isRow(s, m) ? atLeast((column(6) + column(7)) / column(4), least_rate) : NaN
timeError(s, m) = isRow(s, m) ? atLeast(larger(column(8), column(9)), least_time) : NaN

set multiplot layout 2, columns margins 0.075, 0.985, 0.16, 0.95 spacing 0.045, 0.12
unset key
do for [s in sets] {
  set title s
  set ylabel s eq word(sets, 1) ? 'wrong answers / queries' : ''
  set yrange [least_rate / 2 : 1]
  set ytics ('none' least_rate, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, '0.1' 0.1, '1' 1)
  plot for [i=1:words(methods)] table skip 1 using 10:(rate(s, word(methods, i))) \
    with linespoints lc i pt i + 3 lw 1.5 ps 0.9 title word(methods, i)
}
unset title
do for [s in sets] {
  if (s eq word(sets, columns)) {
    set key at screen 0.5, 0.045 center maxrows 2 samplen 2
  }
  set ylabel s eq word(sets, 1) ? 'largest error of the time of contact' : ''
  set yrange [least_time / 2 : 2]
  set ytics ('none' least_time, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, '1' 1)
  plot for [i=1:words(methods)] table skip 1 using 10:(timeError(s, word(methods, i))) \
    with linespoints lc i pt i + 3 lw 1.5 ps 0.9 title word(methods, i)
}
unset multiplot
