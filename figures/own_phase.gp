# When in its half cycle the mass strikes, over the half cycle's amplitude: one decay from right to left.
load folder."/own.gp"
eval require("impacts", 1)
eval canvas(720, 600)
dark = "#BDBDBD"
eval look("impacts", 1)
from = STATS_min / 1.15; to = STATS_max * 1.15
set ylabel "phase of impact in degrees"
set yrange [0:180]
set ytics 30
set mytics 3
eval axis("x", "length", "peak amplitude of the half cycle", "A", from, to, is_wide(from, to))
set key below horizontal maxrows 1 samplen 2 width -3 font ",12"
stuck = !has("stuck") ? "" : \
  'table index "stuck" using ($1*unit_x):2:3 with filledcurves lc rgb dark title "stuck",'.\
  'table index "stuck" using ($1*unit_x):2:(0):($3-$2) with vectors nohead lc rgb dark lw 1 notitle,'
windows = !has("windows") ? "" : \
  ', table index "windows" using ($2*unit_x):(6):(($3-$2)*unit_x):(0) with vectors nohead lc rgb green lw 4 title "impacts per half cycle"'.\
  ', table index "windows" using (unit_x * (is_wide(from, to) ? sqrt($2*$3) : ($2+$3)/2)):(14):1 with labels font ",12" notitle'
forms = ""
do for [b in "bounce-1 bounce-2 bounce-3 bounce-4 accumulation one-impact"] { if (has(b)) { forms = forms.sprintf( \
  ', table index "%s" using ($1*unit_x):2 with lines ls 9 %s', b, strlen(forms) ? "notitle" : 'title "closed forms, ν → 0"') } }
eval 'plot '.stuck.'table index "impacts" using ($1*unit_x):2 with points pt 5 ps 0.2 lc rgb black title "impacts"'.windows.forms
eval axes(name_x, "phase", is_wide(from, to) ? "x" : "")
