# The loss factor of a measured decay over its amplitude, and of the simulated ones.
eval require("measured", 3)
set key top right
set logscale xy
set xlabel "peak amplitude in mm"
set ylabel "loss factor η, per radian" offset 0.5,0
stats table index "measured" using 1 nooutput
set xrange [STATS_min / 1.15:STATS_max * 1.15]
# Near the noise the loss factor may come out negative.
stats table index "measured" using ($2 > 0 ? $2 : NaN) nooutput
set yrange [(STATS_min > STATS_max / 100 ? STATS_min : STATS_max / 100) / 1.5:STATS_max * 5]
set format y "%g"
curve(block, style) = !has(block) ? "" : sprintf("table index '%s' using 1:($2 > 0 ? $2 : NaN) with lines %s title columnheader(2),", block, style)
eval 'plot '.curve("given", "lc rgb grey lw 0.7").curve("fitted", "lc rgb orange lw 0.9").\
  'table index "measured" using 1:($2 > 0 ? $2 : NaN) with points pt 7 ps 0.4 lc rgb black title columnheader(2)'
eval axes("amplitude in mm", "η", "xy")
