from = 0.03
styles = "1"
theory = "1"
set logscale y
set ylabel "loss factor η"
load folder."/loss.gp"
