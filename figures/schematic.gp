# Parts of the schematics A and B, in a plane where both axes have one scale: eval spring(...) and so on.
unset border
unset tics
unset key
set lmargin at screen 0.02
set rmargin at screen 0.98
set bmargin at screen 0.02
eval captioned
set tmargin at screen 0.98
set size ratio -1

line(x, y, to_x, to_y) = sprintf("set arrow from %g,%g to %g,%g nohead lc rgb black lw 1.6 front;", x, y, to_x, to_y)
thin(x, y, to_x, to_y) = sprintf("set arrow from %g,%g to %g,%g nohead lc rgb grey lw 0.9 dt (4,3) front;", x, y, to_x, to_y)
pointing(x, y, to_x, to_y) = sprintf("set arrow from %g,%g to %g,%g head filled size 0.32,18 lc rgb black lw 1.6 front;", x, y, to_x, to_y)
measure(x, to_x, y) = sprintf("set arrow from %g,%g to %g,%g heads filled size 0.28,18 lc rgb black lw 1 front;", x, y, to_x, y)
# A symbol, with its index and argument, or words.
text(x, y, what) = sprintf("set label '%s' at %g,%g center front;", \
  strlen(what) == 1 || what[2:2] eq "_" ? formula(what[1:1]).what[2:strlen(what)] : what[2:2] eq "(" ? formula(what) : what, x, y)
block(x, y, to_x, to_y, colour) = sprintf("set object rectangle from %g,%g to %g,%g fc rgb '%s' fs solid border lc rgb black lw 1.6 behind;", x, y, to_x, to_y, colour)

# Horizontal, from x to to_x at height y, `high` to either side.
spring(x, to_x, y, high) = sprintf( \
  "a = %g; b = %g; y = %g; h = %g; c = a + 0.18 * (b - a); p = 0.64 * (b - a) / 12;".\
  "eval line(a, y, c, y); eval line(c + 12 * p, y, b, y);".\
  "do for [k = 0:11] { eval line(c + k * p, y + h * (k == 0 ? 0 : (k %% 2 ? 1 : -1)), c + (k + 1) * p, y + h * (k == 11 ? 0 : ((k + 1) %% 2 ? 1 : -1))) }", \
  x, to_x, y, high)
damper(x, to_x, y, high) = sprintf( \
  "a = %g; b = %g; y = %g; h = %g; c = a + 0.34 * (b - a); d = a + 0.7 * (b - a); m = a + 0.52 * (b - a);".\
  "eval line(a, y, c, y); eval line(c, y - h, c, y + h); eval line(c, y - h, d, y - h); eval line(c, y + h, d, y + h);".\
  "eval line(m, y - 0.75 * h, m, y + 0.75 * h); eval line(m, y, b, y)", \
  x, to_x, y, high)
# A fixed vertical face at x, hatched on its left; a fixed floor at y, hatched below.
ground(x, y, to_y) = sprintf( \
  "x = %g; y = %g; t = %g; eval line(x, y, x, t);".\
  "do for [k = 0:int((t - y) / 0.55)] { eval line(x, y + 0.55 * k, x - 0.5, y + 0.55 * k - 0.4) }", x, y, to_y)
floor_at(y, x, to_x) = sprintf( \
  "y = %g; x = %g; t = %g; eval line(x, y, t, y);".\
  "do for [k = 1:int((t - x) / 0.55)] { eval line(x + 0.55 * k, y, x + 0.55 * k - 0.4, y - 0.5) }", y, x, to_x)
wheel(x, y, r) = sprintf("set object circle at %g,%g size %g fc rgb 'white' fs solid border lc rgb black lw 1.4 front;", x, y, r)
