# The largest steady amplitude over the force; the prediction read from the free decay, with the spread of its ensemble.
eval require("prediction", 10)
eval require("rising", 10)
eval require("falling", 10)
eval canvas(720, 560)
set logscale y
set xrange [0:0.5]
set yrange [0.03:14]
eval captioned
set xlabel "amplitude ".formula("f₀/ν")." of the force"
set ylabel "largest steady amplitude ".formula("A")
set ytics ("0.03" 0.03, "0.1" 0.1, "0.3" 0.3, "1" 1, "3" 3, "10" 10)
do for [decade in "0.01 0.1 1"] { do for [k=2:9] { if (k != 3 && !(decade == 0.01 && k < 4)) { set ytics add ("" k * decade 1) } } }
set mxtics 5
set key top left Left reverse width 2
band = !has("band") ? "" : 'table index "band" using 1:2 with filledcurves closed lc rgb sky title columnheader(2), '
beyond = !has("beyond") ? "" : ', table index "beyond" using 1:2 with lines lc rgb blue lw 1.4 dt (3,3) title columnheader(2)'
eval 'plot '.band.'table index "prediction" using 1:2 with lines lc rgb blue lw 1.8 title columnheader(2)'.beyond.\
  ', table index "rising" using 1:2 with points pt 9 ps 0.6 lc rgb black title columnheader(2)'.\
  ', table index "falling" using 1:2 with points pt 11 ps 0.6 lc rgb orange title columnheader(2)'
eval axes("f₀/ν", "A", "y")
