# How far the energy balances of the random scenes stay open.
eval require("residuals", 20)
stats table index "residuals" every ::1::1 using 2 name "exact" nooutput
stats table index "residuals" every ::1::1 using 3 name "restitution" nooutput
set logscale xy
set format "10^{%T}"
set xrange [1e-19:1e-8]
set yrange [0.7:1e7]
set xlabel "energy unaccounted for, by what went through the balance"
set ylabel "scenes in half a decade"
set arrow from 1e-10, graph 0 to 1e-10, graph 1 nohead ls 10
set label "allowed" at 1e-10, graph 0.95 right offset -1,0
set label sprintf("not at all open: %d exact, %d restitution", exact_max, restitution_max) at graph 0.03, graph 0.95
set key at graph 0.03, graph 0.89 left Left reverse
# The first row counts those that are not open at all, and an empty half decade has no logarithm.
# Each is drawn about its middle, a quarter of a decade below its upper end.
middle(n) = column(n) / 10**0.25
count(n) = $0 == 0 ? 1/0 : column(n) > 0 ? column(n) : 0.1
plot table index "residuals" using (middle(1)):(count(2)) with histeps ls 1 title "exact", \
     table index "residuals" using (middle(1)):(count(3)) with histeps ls 3 title "restitution"
