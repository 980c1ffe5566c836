# Figures 1-3: the secondary mass as its cavity sees it, and below it what the cavity does meanwhile.
eval require("motion", 100)
eval require("impacts", 1)
stats table index "motion" using 1 name "time" nooutput
stats table index "motion" using 2 nooutput
from = time_min; to = time_max; reach = 1.15 * (STATS_max > -STATS_min ? STATS_max : -STATS_min)

set multiplot
eval captioned
eval panel("a", 0.965)
set xrange [from:to]
set lmargin at screen 0.115
set rmargin at screen 0.975

set tmargin at screen 0.965
set bmargin at screen 0.425
set format x ""
set xtics 2 nomirror scale 0
set mxtics 2
set ytics ("0" 0, "0.5" 0.5, "1" 1)
set yrange [-0.14:1.14]
set ylabel "relative displacement ".formula("y") offset 1,0
set object 1 rectangle from from,-0.14 to to,0 fc rgb pale fs solid noborder behind
set object 2 rectangle from from,1 to to,1.14 fc rgb pale fs solid noborder behind
set label 1 "right wall" at graph 0.01, first 1.07 left font ",11" textcolor rgb grey front
set label 2 "left wall" at graph 0.01, first -0.075 left font ",11" textcolor rgb grey front
set arrow 1 from from,0 to to,0 nohead lc rgb black lw 2.2 front
set arrow 2 from from,1 to to,1 nohead lc rgb black lw 2.2 front
set key at graph 0.985, first 1.07 right center horizontal width 1 font ",11"
stuck = !has("stuck") ? "" : \
  'table index "stuck" using 1:3:($2-$1):(0) with vectors nohead lc rgb orange lw 6 title "stuck",'
eval 'plot table index "motion" using 1:5 with lines lc rgb blue lw 1.6 title "secondary mass",'.stuck.\
  'table index "impacts" using 1:2 with points pt 7 ps 0.45 lc rgb vermillion title "impacts"'
eval axes("t", "y", "")

unset key
unset object
unset label
unset arrow
eval panel("b", 0.395)
set tmargin at screen 0.395
set bmargin at screen 0.13
set xtics 2 nomirror scale 1
set format x "%g"
set xlabel "dimensionless time ".formula("t")
set ylabel "cavity ".formula("x") offset 1,0
set yrange [-reach:reach]
set ytics autofreq
set arrow 3 from from,0 to to,0 nohead lc rgb grey lw 0.6
plot table index "motion" using 1:2 with lines lc rgb black lw 1.4 title "cavity"
eval axes("t", "x", "")
unset multiplot
eval captioned
eval panel("a", 0.965)
