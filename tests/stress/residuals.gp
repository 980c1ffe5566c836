# How far the energy ledgers of the random scenes stay open.
eval require("residuals", 20)
set logscale xy
set format "10^{%T}"
set xrange [1e-20:1e-4]
set yrange [0.7:*]
set xlabel "energy unaccounted for, by what went through the ledger"
set ylabel "scenes in half a decade"
set arrow from 1e-10, graph 0 to 1e-10, graph 1 nohead ls 10
set label "admitted" at 1e-10, graph 0.95 right offset -1,0
set key top left
plot table index "residuals" using 1:($2 > 0 ? $2 : 1/0) with histeps ls 1 title "exact", \
     table index "residuals" using 1:($3 > 0 ? $3 : 1/0) with histeps ls 3 title "restitution"
