# The amplitude under a force over its frequency: with the damper, with the secondary mass locked to its box, with the box empty.
load folder."/own.gp"
eval require("curve", 3)
eval look("curve", 1)
from = STATS_min; to = STATS_max
eval look("curve", 2)
low = STATS_min; high = STATS_max
# A resonance without damping has no end.
do for [b in "locked empty"] {
  eval look(b, 2)
  low = STATS_min < low ? STATS_min : low
  high = STATS_max > high && STATS_max < 3 * high ? STATS_max : high
}
stats table index "given" using 1 nooutput
given = STATS_max
eval axis("x", "frequency", "frequency of the force", "ω", from, to, 0)
eval axis("y", "length", "steady amplitude", "A", low / 1.2, high * 2, 1)
set arrow 1 from given * unit_x,graph 0 to given * unit_x,graph 1 nohead ls 10
plot table index "empty" using ($1*unit_x):($2*unit_y) with lines ls 2 title columnheader(2), \
     table index "locked" using ($1*unit_x):($2*unit_y) with lines ls 3 title columnheader(2), \
     table index "curve" using ($1*unit_x):($2*unit_y) with linespoints ls 1 title columnheader(2)
eval axes(name_x, name_y, "y")
