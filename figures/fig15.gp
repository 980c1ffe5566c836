do for [b in "impacts stuck windows"] { eval require(b, 1) }
set xlabel "peak amplitude A of the half cycle"
set ylabel "phase of impact in degrees"
set xrange [0:6]
set yrange [0:180]
set ytics 30
set mytics 3
set mxtics 5
set key bottom right
set key at graph 0.985, 0.03
plot table index "stuck" using 1:2:3 with filledcurves lc rgb pale title "stuck", \
     table index "impacts" using 1:2 with points pt 5 ps 0.16 lc rgb black title "impacts", \
     table index "one-impact" using 1:2 with lines ls 9 title columnheader(2), \
     for [i=1:4] table index sprintf("bounce-%d", i) using 1:2 with lines ls 9 notitle, \
     table index "accumulation" using 1:2 with lines ls 9 notitle
