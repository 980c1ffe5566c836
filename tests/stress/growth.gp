# Growth of the fastest mode per step of central differences: measured, and the roots of the characteristic
# polynomial.
styles = "1 2 3 4 9"
modes = "flight-0 flight-0.05 contact-1 contact-0.6 contact-0.1"
names = "'in flight, ζ = 0' 'in flight, ζ = 0.05' 'in contact, e = 1' 'in contact, e = 0.6' 'in contact, e = 0.1'"
do for [damper in "centred lagged"] { do for [mode in modes] { eval require(damper."-".mode, 6); eval require(damper."-".mode."-closed", 50) } }
eval canvas(1080, 480)
unset title
set multiplot layout 1,2 title title font ",15" margins 0.075,0.985,0.13,0.82 spacing 0.07
set xrange [0.45:1.12]
set yrange [0.4:2.6]
set xlabel "step by its stability limit"
set ylabel "growth per step |λ|" offset 1,0
set arrow from 1,0.4 to 1,2.6 nohead ls 10
set key top left
do for [damper in "centred lagged"] {
  set title damper." damper" font ",13"
  plot for [i=1:5] table index damper."-".word(modes, i)."-closed" using 1:2 with lines ls word(styles, i)+0 notitle, \
       for [i=1:5] table index damper."-".word(modes, i) using 1:2 with points ls word(styles, i)+0 pt 6 ps 1 title word(names, i)
  unset ylabel
}
unset multiplot
