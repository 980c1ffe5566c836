# A measured decay over time, and the simulated ones: of the scene as it was given, and with the numbers fitted.
eval require("measured", 3)
set key bottom left
set logscale y
set xlabel "time in s"
set ylabel "peak amplitude in mm" offset 0.5,0
stats table index "measured" using 1 nooutput
from = STATS_min; to = STATS_max
stats table index "measured" using 2 nooutput
least = STATS_min; most = STATS_max
# What of the record is left out, if anything.
if (has("others")) {
  stats table index "others" using 1 nooutput
  from = STATS_min < from ? STATS_min : from; to = STATS_max > to ? STATS_max : to
  stats table index "others" using 2 nooutput
  least = STATS_min < least ? STATS_min : least; most = STATS_max > most ? STATS_max : most
}
set xrange [from:from + 1.05 * (to - from)]
set yrange [least / 1.5:most * 1.5]
curve(block, style) = !has(block) ? "" : sprintf("table index '%s' using 1:2 with lines %s title columnheader(2),", block, style)
points(block, style) = !has(block) ? "" : sprintf("table index '%s' using 1:2 with points %s title columnheader(2),", block, style)
eval 'plot '.points("others", "pt 6 ps 0.35 lc rgb grey").curve("given", "lc rgb grey lw 0.7").curve("fitted", "lc rgb orange lw 0.9").\
  'table index "measured" using 1:2 with points pt 7 ps 0.35 lc rgb black title columnheader(2)'
eval axes("time in s", "amplitude in mm", "y")
