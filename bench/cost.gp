# What an impact costs against number of impacts, stiffness and restitution; below it the residual of the energy balance.
# `table` as sweep_table writes it.
do for [block in "exact-impacts exact-stiffness exact-restitution restitution-impacts restitution-restitution"] { \
  eval require(block, 2) }

eval canvas(1080, 640)
set output output
set multiplot layout 2,3 title "What an impact costs, everything included\n{/*0.82 ".parameters."}" font ",15" \
  offset 0,-0.2 margins 0.095,0.985,0.11,0.89 spacing 0.05,0.06
set grid lc rgb pale lt 1
set logscale y
set mxtics 1
set key bottom right
set title ""

do for [row in "cost residual"] {
  do for [against in "impacts stiffness restitution"] {
    if (against eq "restitution") { unset logscale x; set format x "%g"; set xrange [0:1]; set xtics 0,0.2,1
    } else { set logscale x; set format x "10^{%T}"; set xtics 1e2,10
      set xrange [50 : (against eq "impacts" ? 2e7 : 2e10)] }
    column_ = row eq "cost" ? 2 : 5
    if (row eq "cost") { set yrange [1:1000]; set format y "%g"; set format x ""; unset xlabel
    } else { set yrange [1e-16:1e-10]; set format y "10^{%T}"
      set xlabel against eq "impacts" ? "number of impacts, e = 1" : against eq "stiffness" ? "wall stiffness k" : "restitution e" }
    set ylabel against ne "impacts" ? "" : row eq "cost" ? "reference operations per impact" : "residual of the energy balance"
    command = sprintf("plot table index 'exact-%s' using 1:%d with linespoints ls 1 title 'exact'", against, column_)
    if (against ne "stiffness") {
      command = command.sprintf(", table index 'restitution-%s' using 1:%d with linespoints ls 3 title 'restitution'", against, column_)
    }
    eval command
    unset key
  }
}
unset multiplot
