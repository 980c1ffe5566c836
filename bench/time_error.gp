# Run time against error, a panel for each scene, the key below them. `table` as time_error_table writes it.
scenes = "S1 S2 S3 S4 S5 S7 S8-slow S8-fast S8-very-fast"
array heads[9] = ["x_0 = 4.5 to t = 100", "the same, rigid walls", "x_0 = 6 to t = 400: bounce-down", "forced and damped", \
  "the whole decay, 6 to 0.03", "forced near resonance, undamped", "a force of frequency 0.2", "of frequency 5", "of frequency 50"]
do for [block in "S1-exact S2-restitution S3-exact S4-exact S5-exact S5-scatter S7-exact S8-fast-exact"] { eval require(block, 1) }
do for [block in "S1-cem S1-central-differences S3-central-differences"] { eval require(block, 2) }
# Where the ensemble's own members lie: before any range is set, which would narrow the statistics.
stats table index "S5-scatter" using 1 nooutput; low = STATS_min
stats table index "S5-scatter" using 3 nooutput; high = STATS_max

eval canvas(1180, 1320)
set output output
set multiplot layout 3,3 title "Run time against error\n{/*0.82 ".parameters."}" font ",15" offset 0,-0.2 \
  margins 0.065,0.985,0.145,0.925 spacing 0.055,0.08
set logscale xy
set format "10^{%T}"
set yrange [1e2:2e8]
set ytics 10
set mxtics 1
set grid lc rgb pale lt 1
unset key

# What two recorded amplitudes can differ by at all; an error below it is drawn at it.
floor_of(error) = error > 4.4e-16 ? error : 4.4e-16
names = "exact restitution cem cem-two-rates cem-located cem-located-two-rates odeint-fehlberg78 odeint-dopri5 CVODE ARKODE ".\
        "Siconos-Moreau-Jean Siconos-event-driven central-differences"
array styles[13] = [ \
  "lc rgb black pt 7 ps 1.4", "lc rgb black pt 6 ps 1.4 lw 1.6", \
  "lc rgb green pt 8 ps 0.8 dt (3,2.5)", "lc rgb green pt 10 ps 0.8", \
  "lc rgb orange pt 9 ps 0.8 dt (3,2.5)", "lc rgb orange pt 11 ps 0.8", \
  "lc rgb vermillion pt 5 ps 0.6", "lc rgb vermillion pt 4 ps 0.6 dt (9,3)", \
  "lc rgb blue pt 13 ps 0.8", "lc rgb blue pt 12 ps 0.8 dt (9,3)", \
  "lc rgb purple pt 1 ps 0.8", "lc rgb purple pt 2 ps 0.8 dt (9,3)", \
  "lc rgb grey pt 3 ps 0.7"]
spelled(name) = system("echo '".name."' | sed 's/-/ /; s/-two-rates/, two rates/; s/two-rates/two rates/'")
# What a scene's contenders are drawn by; those that are not there are not missed.
contenders(scene) = system("for name in ".names."; do if grep -q -x \"# ".scene."-$name\" '".table."'; then echo $name; fi; done")
number_of(name) = int(system("i=0; for n in ".names."; do i=$((i+1)); if [ $n = ".name." ]; then echo $i; fi; done"))

do for [panel=1:9] {
  scene = word(scenes, panel)
  here = contenders(scene)
  set xrange [(scene eq "S5" ? 5e-4 : 1e-16) : 1]
  if (scene eq "S5") { set xtics 1e-3,10,1 } else { set xtics 1e-16,1e4,1 }
  set title scene[1:2].": ".heads[panel] font ",13"
  set ylabel panel % 3 == 1 ? "run time in reference operations" : ""
  set xlabel scene eq "S5" ? "error of the loss factor's curve" : "error of a half-cycle amplitude"
  if (scene eq "S5") {
    set object 1 rectangle from low, graph 0 to high, graph 1 fc rgb pale fs solid noborder behind
  }
  command = "plot "
  do for [name in here] {
    command = command.sprintf("table index '%s-%s' using (floor_of($1)):2 with linespoints %s notitle, ", \
      scene, name, styles[number_of(name)])
  }
  eval command."1/0 notitle"
  unset object 1
}

set lmargin at screen 0.05; set rmargin at screen 0.9; set bmargin at screen 0.005; set tmargin at screen 0.095
set title ""
unset xlabel
unset ylabel
unset border
unset tics
unset grid
unset logscale
set xrange [0:1]
set yrange [0:1]
set key at graph 0.02, graph 0.98 top left Left reverse vertical maxrows 4 spacing 1.1 font ",13"
command = "plot "
do for [i=1:13] {
  name = word(names, i)
  if (system("grep -c -- '^# S[0-9].*-".name."$' '".table."' || true") > 0) {
    command = command.sprintf("1/0 with linespoints %s title '%s', ", styles[i], spelled(name))
  }
}
eval command."1/0 with boxes fc rgb pale fs solid title 'scatter of the ensemble'"
unset multiplot
