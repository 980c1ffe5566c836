# The secondary mass as its cavity sees it, and below it what the cavity does meanwhile.
load folder."/own.gp"
eval require("motion", 10)
stats table index "motion" using 1 name "time" nooutput
eval look("motion", 2)
from = time_min; to = time_max
reach = STATS_max > -STATS_min ? STATS_max : -STATS_min; reach = reach > 0 ? 1.15 * reach : 1
eval look("motion", 5)
# A compliant wall is pressed in, and a mass may begin outside.
below = STATS_min < -0.14 ? STATS_min * 1.05 : -0.14
above = STATS_max > 1.14 ? 1 + (STATS_max - 1) * 1.05 : 1.14

set multiplot
set lmargin at screen 0.115
top = in_units ? 0.795 : 0.875

set tmargin at screen top
set bmargin at screen 0.385
eval axis("x", "time", "time", "t", from, to, 0)
eval axis("y", "length", "relative displacement", "y", below, above, 0)
wall = unit_y; begin = from * unit_x; end = to * unit_x
unset mx2tics  # the legend is there
unset xlabel
set format x ""
if (in_units) {
  set ytics wall / 2
  set y2tics ("0" 0, "0.5" 0.5, "1" 1)
  set ylabel sprintf("relative, in %s", unit_of("length", above * scale_length)) offset 1,0
  set y2label "y, dimensionless" offset -0.8,0
  set rmargin at screen 0.90
} else {
  set ytics ("0" 0, "0.5" 0.5, "1" 1)
  set ylabel "relative displacement y" offset 1,0
  set rmargin at screen 0.975
}
set object 1 rectangle from begin,below * unit_y to end,0 fc rgb pale fs solid noborder behind
set object 2 rectangle from begin,wall to end,above * unit_y fc rgb pale fs solid noborder behind
set label 1 "right wall" at begin,1.07 * wall left offset 0.5,0 font ",11" textcolor rgb grey front
set label 2 "left wall" at begin,-0.075 * wall left offset 0.5,0 font ",11" textcolor rgb grey front
set arrow 1 from begin,0 to end,0 nohead lc rgb black lw 2.2 front
set arrow 2 from begin,wall to end,wall nohead lc rgb black lw 2.2 front
set key at graph 0.985, first 1.07 * wall right center horizontal width 1 font ",11"
stuck = !has("stuck") ? "" : \
  ', table index "stuck" using ($1*unit_x):($3*unit_y):(($2-$1)*unit_x):(0) with vectors nohead lc rgb orange lw 6 title "stuck"'
impacts = !has("impacts") ? "" : \
  ', table index "impacts" using ($1*unit_x):($2*unit_y) with points pt 7 ps 0.45 lc rgb vermillion title "impacts"'
eval 'plot table index "motion" using ($1*unit_x):($5*unit_y) with lines lc rgb blue lw 1.6 title "secondary mass"'.stuck.impacts
eval axes(name_x, in_units ? name_y : "y", "")

unset key
unset title
unset object
unset label
unset arrow
unset x2tics
unset x2label
set tmargin at screen 0.355
set bmargin at screen 0.13
set format x "%g"
set xlabel in_units ? name_x : "dimensionless time t"
eval axis("y", "length", "cavity", "x", -reach, reach, 0)
set ylabel in_units ? sprintf("cavity, in %s", unit_of("length", reach * scale_length)) : "cavity x" offset 1,0
if (in_units) { set y2label "x, dimensionless" offset -0.8,0; set rmargin at screen 0.90 } else { set rmargin at screen 0.975 }
# Three marks each way at most, round ones: the panel is low.
step(reach) = (power = 10 ** floor(log10(reach)), reach / power < 2 ? power : reach / power < 5 ? 2 * power : 5 * power)
set ytics step(reach * unit_y)
if (in_units) { set y2tics step(reach) }
set arrow 3 from begin,0 to end,0 nohead lc rgb grey lw 0.6
plot table index "motion" using ($1*unit_x):($2*unit_y) with lines lc rgb black lw 1.4 title "cavity"
eval axes(name_x, name_y, "")
unset multiplot
