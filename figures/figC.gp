# Four panels, one for each force: what sweeps end in, the branches of periodic motions, stable or not, and the two linear
# oscillators.
panels = system(sprintf("grep -c -x '# panel-[0-9]*' '%s' || true", table)) + 0
do for [i=1:panels] { eval require(sprintf("panel-%d", i), 1); eval require(sprintf("empty-%d", i), 10) }
eval canvas(720, 780)
set multiplot
heading = title.(strlen(parameters) ? "\n{/*0.82 ".parameters."}" : "")
unset title
set logscale y
set yrange [0.02:5]
# With numbers on the left only.
numbers(yes) = "set ytics (".(yes ? \
  '"0.02" 0.02, "0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2, "5" 5' : \
  '"" 0.02, "" 0.05, "" 0.1, "" 0.2, "" 0.5, "" 1, "" 2, "" 5').\
  ', "" 0.03 1, "" 0.04 1, "" 0.06 1, "" 0.07 1, "" 0.08 1, "" 0.09 1, "" 0.3 1, "" 0.4 1, "" 0.6 1, "" 0.7 1, "" 0.8 1, "" 0.9 1, "" 3 1, "" 4 1)'
left(i) = i % 2 ? 0.105 : 0.545
top(i) = i < 3 ? 0.900 : 0.555
# A clause for a block that may not be there.
of(i, kind, how) = !has(sprintf("%s-%d", kind, i)) ? "" : sprintf(', table index "%s-%d" using 1:2 with %s', kind, i, how)
do for [i=1:panels] {
  stats table index sprintf("empty-%d", i) using 1 nooutput
  set xrange [STATS_min - 0.001:STATS_max + 0.001]
  set xtics 0.02
  set mxtics 4
  stats table index sprintf("panel-%d", i) using 1 nooutput
  set label 1 sprintf("f₀ = %.2f ν", STATS_max) at graph 0.04,graph 0.93 left font ",14"
  set lmargin at screen left(i)
  set rmargin at screen left(i) + 0.425
  set tmargin at screen top(i)
  set bmargin at screen top(i) - 0.325
  if (i == 1) { set label 2 heading at screen 0.5,screen 0.965 center font ",15" } else { unset label 2 }
  if (i > 2) { set xlabel "frequency ω of the force"; set format x } else { unset xlabel; set format x "" }
  if (i % 2) { set ylabel "largest amplitude A" offset 1.2,0 } else { unset ylabel }
  eval numbers(i % 2)
  unset key
  eval sprintf('plot table index "empty-%d" using 1:2 with lines lc rgb blue lw 1 dt (6,3)', i).\
    sprintf(', table index "locked-%d" using 1:2 with lines lc rgb vermillion lw 1 dt (6,3,1.5,3)', i).\
    of(i, "unstable", "lines lc rgb purple lw 1.6 dt (4,3)").\
    of(i, "rising-open", "points pt 8 ps 0.45 lc rgb black").\
    of(i, "falling-open", "points pt 10 ps 0.45 lc rgb orange").\
    of(i, "rising", "points pt 9 ps 0.6 lc rgb black").\
    of(i, "falling", "points pt 11 ps 0.6 lc rgb orange").\
    of(i, "stable", "lines lc rgb green lw 1.6")
  eval axes("ω", "A", "y")
}
# One key for all.
unset title
unset label
unset border
unset tics
unset xlabel
unset ylabel
unset logscale
set lmargin at screen 0.02
set rmargin at screen 0.98
set tmargin at screen 0.140
set bmargin at screen 0.010
set key inside center center maxrows 4 Left reverse width 2 font ",12"
set xrange [0:1]
set yrange [0:1]
plot NaN with lines lc rgb blue lw 1 dt (6,3) title "without the secondary mass", \
     NaN with lines lc rgb vermillion lw 1 dt (6,3,1.5,3) title "secondary mass locked", \
     NaN with lines lc rgb green lw 1.6 title "periodic, stable", \
     NaN with lines lc rgb purple lw 1.6 dt (4,3) title "periodic, unstable", \
     NaN with points pt 9 ps 0.6 lc rgb black title "frequency rising", \
     NaN with points pt 11 ps 0.6 lc rgb orange title "frequency falling", \
     NaN with points pt 8 ps 0.6 lc rgb black title "not periodic, rising", \
     NaN with points pt 10 ps 0.6 lc rgb orange title "not periodic, falling"
unset multiplot
