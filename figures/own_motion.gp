# The loose mass as its cavity sees it, and below it what the cavity does meanwhile.
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
set format x ""
set ytics ("0" 0, "0.5" 0.5, "1" 1)
set yrange [below:above]
set ylabel "relative displacement y" offset 1,0
eval axis("x", "time", from, to, 0)
unset mx2tics  # the legend is there
if (in_units) {
  set y2range [below * scale_length:above * scale_length]
  set y2tics
  set ytics nomirror
  set y2label "in mm" offset -0.8,0
  set rmargin at screen 0.90
} else {
  set rmargin at screen 0.975
}
set object 1 rectangle from from,below to to,0 fc rgb pale fs solid noborder behind
set object 2 rectangle from from,1 to to,above fc rgb pale fs solid noborder behind
set label 1 "right wall" at from,1.07 left offset 0.5,0 font ",11" textcolor rgb grey front
set label 2 "left wall" at from,-0.075 left offset 0.5,0 font ",11" textcolor rgb grey front
set arrow 1 from from,0 to to,0 nohead lc rgb black lw 2.2 front
set arrow 2 from from,1 to to,1 nohead lc rgb black lw 2.2 front
set key at graph 0.985, first 1.07 right center horizontal width 1 font ",11"
stuck = !has("stuck") ? "" : \
  ', table index "stuck" using 1:3:($2-$1):(0) with vectors nohead lc rgb orange lw 6 title "stuck"'
impacts = !has("impacts") ? "" : \
  ', table index "impacts" using 1:2 with points pt 7 ps 0.45 lc rgb vermillion title "impacts"'
eval 'plot table index "motion" using 1:5 with lines lc rgb blue lw 1.6 title "loose mass"'.stuck.impacts
eval axes("t", "y", "")

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
set xlabel "dimensionless time t"
set ylabel "cavity x" offset 1,0
set yrange [-reach:reach]
if (in_units) { set y2range [-reach * scale_length:reach * scale_length] }
# Three marks each way at most, round ones: the panel is low.
step(reach) = (power = 10 ** floor(log10(reach)), reach / power < 2 ? power : reach / power < 5 ? 2 * power : 5 * power)
set ytics step(reach)
if (in_units) { set y2tics step(reach * scale_length) }
set arrow 3 from from,0 to to,0 nohead lc rgb grey lw 0.6
plot table index "motion" using 1:2 with lines lc rgb black lw 1.4 title "cavity"
eval axes("t", "x", "")
unset multiplot
