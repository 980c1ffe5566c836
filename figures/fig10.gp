from = 0.03
styles = "1 2 3 4"
theory = "1"
set logscale y
set yrange [4e-4:0.3]
set ylabel "loss factor η"
load folder."/loss.gp"
