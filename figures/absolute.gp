# Figures 4-6: both walls of the cavity and, between them, the secondary mass, as someone at rest sees them.
eval require("motion", 100)
eval require("impacts", 1)
stats table index "motion" using 1 name "time" nooutput
stats table index "motion" using 2 nooutput
from = time_min; to = time_max
reach = STATS_max > -STATS_min ? STATS_max : -STATS_min

set xrange [from:to]
set yrange [-reach - 0.15:1 + reach + 0.32]
eval captioned
set xlabel "dimensionless time ".formula("t")
set ylabel "absolute displacement"
set key top right horizontal
plot table index "motion" using 1:2 with lines lc rgb black lw 2 title "cavity walls", \
     table index "motion" using 1:3 with lines lc rgb black lw 2 notitle, \
     table index "motion" using 1:4 with lines lc rgb blue lw 1.6 dt (7,3.5) title "secondary mass", \
     table index "impacts" using 1:3 with points pt 7 ps 0.5 lc rgb vermillion title "impacts"
eval axes("t", "displacement", "")
