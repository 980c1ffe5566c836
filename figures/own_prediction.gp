# How far releases part that differ by a millionth at most: of their amplitudes the spread, in percent of the median.
load folder."/own.gp"
eval require("curve", 3)
eval look("curve", 1)
to = STATS_max
eval look("curve", 2)
set logscale y
set format y "10^{%T}"
set yrange [STATS_min / 3:STATS_max > 3 ? STATS_max * 3 : 10]
set ylabel "spread of the amplitudes in percent"
eval axis("x", "time", "time", "t", 0, to, 0)
plot table index "curve" using ($1*unit_x):2 with lines ls 1 title "spread of all releases", \
     1 with lines ls 10 dt (6,4) title "one percent"
eval axes(name_x, "spread in percent", "y")
