from = 0.03
styles = "1"
theory = "1"
logarithmic = "xy"
ordinate = "η"
set ylabel "loss factor ".ordinate
load folder."/loss.gp"
