# A measured decay over time, and the simulated ones: of the scene as it was given, and with the numbers fitted.
eval require("measured", 3)
set key top right
set logscale y
set xlabel "time in s"
set ylabel "peak amplitude in mm" offset 0.5,0
stats table index "measured" using 1 nooutput
from = STATS_min; to = STATS_max
set xrange [from:from + 1.05 * (to - from)]
stats table index "measured" using 2 nooutput
set yrange [STATS_min / 1.5:STATS_max * 1.5]
curve(block, style) = !has(block) ? "" : sprintf("table index '%s' using 1:2 with lines %s title columnheader(2),", block, style)
eval 'plot '.curve("given", "lc rgb grey lw 0.7").curve("fitted", "lc rgb orange lw 0.9").\
  'table index "measured" using 1:2 with points pt 7 ps 0.35 lc rgb black title columnheader(2)'
eval axes("time in s", "amplitude in mm", "y")
