# Figures C and J: panels one below the other, one for each force: what sweeps end in, the branches of periodic motions, stable
# or not, the closed form and the two linear oscillators, as far as the table has them. What is not periodic is small and
# pale, so that the branches can be followed through it.
panels = system(sprintf("grep -c -x '# panel-[0-9]*' '%s' || true", table)) + 0
do for [i=1:panels] { eval require(sprintf("panel-%d", i), 1); eval require(sprintf("empty-%d", i), 10) }
height = 269.08 * panels + 163.68
eval canvas(720, height)
part(pixels) = pixels / height
set multiplot
eval captioned
set logscale y
set yrange [0.03:5]
set ytics ("0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2, "5" 5)
do for [decade in "0.01 0.1 1"] { do for [k=3:9] { if (k != 5 && k * decade < 5) { set ytics add ("" k * decade 1) } } }
set lmargin at screen 0.105
set rmargin at screen 0.975
top(i) = 1 - part(18.6 + 269.08 * (i - 1))
faint_black = "#8C8C8C"; faint_orange = "#EFC260"
# A clause for a block that may not be there.
of(i, kind, how) = !has(sprintf("%s-%d", kind, i)) ? "" : sprintf(', table index "%s-%d" using 1:2 with %s', kind, i, how)
do for [i=1:panels] {
  stats table index sprintf("empty-%d", i) using 1 nooutput
  set xrange [STATS_min - 0.001:STATS_max + 0.001]
  set xtics 0.02
  set mxtics 4
  stats table index sprintf("panel-%d", i) using 1 nooutput
  set label 1 sprintf("{/:Italic f}₀ = %.2f {/:Italic ν}", STATS_max) at graph 0.02,graph 0.91 left font ",14"
  eval panel(substr("abcdefgh", i, i), top(i))
  set tmargin at screen top(i)
  set bmargin at screen top(i) - part(254.2)
  if (i == panels) { set xlabel "frequency ".formula("ω")." of the force"; set format x } else { unset xlabel; set format x "" }
  set ylabel "largest amplitude ".formula("A") offset 1.2,0
  unset key
  eval sprintf('plot table index "empty-%d" using 1:2 with lines lc rgb blue lw 1 dt (6,3)', i).\
    sprintf(', table index "locked-%d" using 1:2 with lines lc rgb vermillion lw 1 dt (6,3,1.5,3)', i).\
    of(i, "rising-open", "points pt 8 ps 0.35 lw 0.6 lc rgb faint_black").\
    of(i, "falling-open", "points pt 10 ps 0.35 lw 0.6 lc rgb faint_orange").\
    of(i, "rising", "points pt 9 ps 0.55 lc rgb black").\
    of(i, "falling", "points pt 11 ps 0.55 lc rgb orange").\
    of(i, "unstable", "lines lc rgb purple lw 2 dt (4,3)").\
    of(i, "stable", "lines lc rgb green lw 2").\
    of(i, "plastic", "lines lc rgb purple lw 1.6")
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
set tmargin at screen part(99.2)
set bmargin at screen part(4.96)
set key inside center center maxrows 4 Left reverse width 2 font ",12"
set xrange [0:1]
set yrange [0:1]
branches = !has("stable-[0-9]*") ? "" : \
  ', NaN with lines lc rgb green lw 2 title "periodic, stable"'.\
  ', NaN with lines lc rgb purple lw 2 dt (4,3) title "periodic, unstable"'
closed = !has("plastic-[0-9]*") ? "" : ', NaN with lines lc rgb purple lw 1.6 title "two impacts, closed form, ".formula("ν")." → 0"'
eval 'plot NaN with lines lc rgb blue lw 1 dt (6,3) title "without the secondary mass"'.\
  ', NaN with lines lc rgb vermillion lw 1 dt (6,3,1.5,3) title "secondary mass locked"'.branches.closed.\
  ', NaN with points pt 9 ps 0.6 lc rgb black title "frequency rising"'.\
  ', NaN with points pt 11 ps 0.6 lc rgb orange title "frequency falling"'.\
  ', NaN with points pt 8 ps 0.5 lw 0.6 lc rgb faint_black title "not periodic, rising"'.\
  ', NaN with points pt 10 ps 0.5 lw 0.6 lc rgb faint_orange title "not periodic, falling"'
unset multiplot
