# The loss factor over amplitude, its ensemble, and the closed forms thinly beside it.
load folder."/own.gp"
eval require("curve-1", 10)
eval look("curve-1", 1)
from = STATS_min / 1.15; to = STATS_max * 1.15
fold = 0
if (has("fold")) {
  stats table index "fold" using 1 nooutput
  fold = STATS_max
  from = fold / 1.15 < from ? fold / 1.15 : from
}
# After failure the amplitude is often below the axis; a legend for nothing is no help.
is_seen = 0
if (has("failed-1")) {
  stats table index "failed-1" using 1 nooutput
  is_seen = STATS_max > from
}
eval look("curve-1", 2)
logarithmic = (is_wide(from, to) ? "x" : "").(STATS_min > 0 ? "y" : "")
if (STATS_min > 0) {
  set logscale y
  set yrange [STATS_min / 1.5:STATS_max * 3]
  bottom = STATS_min / 1.4
  eval marks("y", STATS_min / 1.5, STATS_max * 3)
} else {
  set yrange [STATS_min - 0.1 * STATS_max:1.5 * STATS_max]
  bottom = STATS_min - 0.07 * STATS_max
}
set ylabel "loss factor η, per radian" offset 0.5,0
eval axis("x", "length", "peak amplitude", "A", from, to, is_wide(from, to))
optional(block, clause) = !has(block) ? "" : sprintf("table index '%s' using ", block).clause
forms = optional("one-impact-1", '($1*unit_x):2 with lines ls 9 title "closed forms, ν → 0",').\
  optional("bounce-down-1", '($1*unit_x):2 with lines ls 9 notitle,')
if (fold > 0 && fold < to) {
  set arrow 1 from fold * unit_x,graph 0 to fold * unit_x,graph 1 nohead ls 10 dt (6,4)
  set label 1 "impacts fail" at fold * unit_x,graph 0.03 left offset 0.4,0 font ",11" textcolor rgb grey
}
eval 'plot '.optional("band-1", '($1*unit_x):2:3 with filledcurves lc rgb sky title columnheader(3),').forms.\
  (!is_seen ? "" : optional("failed-1", '($1*unit_x):2 with points pt 7 ps 0.35 lc rgb vermillion title "after impact failure",')).\
  optional("folds", '($1*unit_x):(bottom) with points pt 9 ps 0.7 lc rgb grey title "a damper'."'".'s impacts fail",').\
  'table index "curve-1" using ($1*unit_x):2 with lines ls 1 title columnheader(2)'
eval axes(name_x, "η", logarithmic)
