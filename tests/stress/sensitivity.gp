# Figure 15 again, and under it, over the same amplitudes, how a perturbation grows: per half cycle in the base
# case, and in sum along all eight decays.
base = "nu2-e06"
others = "nu1-e06 nu4-e06 nu2-e04 nu2-e08 nu2-e06-zeta02 nu2-e06-zeta04 nu2-e06-zeta08"
eval require("exponents-".base, 50)
do for [name in base." ".others] { eval require("growth-".name, 10) }
eval canvas(1080, 900)
unset title
set multiplot title title."\n{/*0.82 ".parameters."}" font ",15"
left_1 = 0.075; right_1 = 0.64; left_2 = 0.70; right_2 = 0.985
top(row) = 0.915 - 0.29 * row
bottom(row) = top(row) - 0.265
# Below this a perturbation is gone within few half cycles, down to the last bit where the mass sticks.
floor_of(exponent) = exponent < -1.5 ? -1.5 : exponent
forgets(exponent) = exponent < 0 ? floor_of(exponent) : 1/0
grows(exponent) = exponent < 0 ? 1/0 : exponent
do for [column=1:2] {
  if (column == 1) { set lmargin at screen left_1; set rmargin at screen right_1; set xrange [0:6]; set xtics 1; set mxtics 5 }
  if (column == 2) { set lmargin at screen left_2; set rmargin at screen right_2; set xrange [0:0.6]; set xtics 0.1; set mxtics 5 }
  width = column == 1 ? 0.05 : 0.01
  unset xlabel
  set format x ""
  set tmargin at screen top(0); set bmargin at screen bottom(0)
  set yrange [0:180]; set ytics 30; set mytics 3
  if (column == 1) { set ylabel "phase of impact in degrees" offset 1,0 } else { unset ylabel }
  plot table index "impacts-".base using 1:2 with points pt 5 ps (column == 1 ? 0.13 : 0.2) lc rgb black notitle, \
       table index "windows-".base using 2:(8):($3-$2):(0) with vectors nohead lc rgb green lw 4 notitle, \
       table index "windows-".base using (($2+$3)/2 < 0.6*(3-column) || column == 1 ? ($2+$3)/2 : 1/0):(19):1 with labels font ",12" notitle

  set tmargin at screen top(1); set bmargin at screen bottom(1)
  set yrange [-1.6:2]; set ytics 0.5; set mytics 1
  if (column == 1) { set ylabel "growth per half cycle, ln" offset 1,0 }
  if (column == 1) { set key top right maxrows 3 } else { unset key }
  set style fill solid 0.9 noborder
  plot table index "exponents-".base using 1:(forgets($3)):(width) with boxes lc rgb blue title "at equal amplitude: forgotten", \
       table index "exponents-".base using 1:(grows($3)):(width) with boxes lc rgb orange title "at equal amplitude: grows", \
       table index "exponents-".base using 1:(floor_of($2)) with lines lc rgb black lw 1.3 title "in full", \
       0 with lines ls 10 notitle

  set format x "%g"
  set tmargin at screen top(2); set bmargin at screen bottom(2)
  set xlabel "peak amplitude A of the half cycle"
  set yrange [-13:0]; set ytics 3; set mytics 3
  if (column == 1) { set ylabel "10^{-12} at the release becomes 10^n" offset 1,0 }
  if (column == 1) { set key at graph 0.94, 0.95 right top maxcols 1 maxrows 8 samplen 1.6 spacing 1 font ",11" }
  plot table index "growth-".base using 1:2 with lines lc rgb black lw 2 title "ν = 0.02, e = 0.6, ζ = 0", \
       table index "growth-nu1-e06" using 1:2 with lines lc rgb blue lw 1.2 title "ν = 0.01", \
       table index "growth-nu4-e06" using 1:2 with lines lc rgb blue lw 1.2 dt (6,3) title "ν = 0.04", \
       table index "growth-nu2-e04" using 1:2 with lines lc rgb vermillion lw 1.2 title "e = 0.4", \
       table index "growth-nu2-e08" using 1:2 with lines lc rgb vermillion lw 1.2 dt (6,3) title "e = 0.8", \
       table index "growth-nu2-e06-zeta02" using 1:2 with lines lc rgb green lw 1.2 title "ζ = 0.002", \
       table index "growth-nu2-e06-zeta04" using 1:2 with lines lc rgb green lw 1.2 dt (6,3) title "ζ = 0.004", \
       table index "growth-nu2-e06-zeta08" using 1:2 with lines lc rgb green lw 1.2 dt (2,3) title "ζ = 0.008"
}
unset multiplot
