# The amplitude under a force over its frequency: with the damper, the frequency rising and falling; with the secondary mass
# locked to its box; with the box empty. A motion that is not periodic has an open mark.
load folder."/own.gp"
eval require("empty", 3)
eval look("empty", 1)
from = STATS_min; to = STATS_max
low = 1e300; high = 0
marks_there = ""
do for [b in "rising falling rising-open falling-open"] {
  if (has(b)) {
    marks_there = marks_there." ".b
    eval look(b, 2)
    low = STATS_min < low ? STATS_min : low
    high = STATS_max > high ? STATS_max : high
  }
}
if (high <= 0) { printerr "there is no motion to draw"; exit status 1 }
# A resonance without damping, or with little, would leave no room for the damper.
end = high
do for [b in "locked empty"] {
  eval look(b, 2)
  low = STATS_min < low ? STATS_min : low
  high = STATS_max > high && STATS_max < 30 * end ? STATS_max : high
}
stats table index "given" using 1 nooutput
given = STATS_max
eval axis("x", "frequency", "frequency of the force", "ω", from, to, 0)
eval axis("y", "length", "largest amplitude", "A", low / 1.2, high * 2, 1)
set arrow 1 from given * unit_x,graph 0 to given * unit_x,graph 1 nohead ls 10
if (strstrt(marks_there, "-open")) {
  set label 1 "open: not periodic" at graph 0.975,graph 0.7 right font ",11" textcolor rgb grey
}
# Of the marks of one colour the first are in the legend.
points_of(b) = sprintf(', table index "%s" using ($1*unit_x):($2*unit_y) with points pt %d ps 0.6 lc rgb %s %s', b, \
  b eq "rising" ? 9 : b eq "rising-open" ? 8 : b eq "falling" ? 11 : 10, b[1:6] eq "rising" ? "black" : "orange", \
  strstrt(b, "-open") && has(b[1:strstrt(b, "-open") - 1]) ? "notitle" : 'title "'.(b[1:6] eq "rising" ? "frequency rising" : "frequency falling").'"')
drawn = ""
do for [b in marks_there] { drawn = drawn.points_of(b) }
eval 'plot table index "empty" using ($1*unit_x):($2*unit_y) with lines ls 2 title columnheader(2)'.\
  ', table index "locked" using ($1*unit_x):($2*unit_y) with lines ls 3 title columnheader(2)'.drawn
eval axes(name_x, name_y, "y")
