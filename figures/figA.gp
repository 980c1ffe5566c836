load folder."/schematic.gp"
eval canvas(720, 470)
set xrange [0:25]
set yrange [0:14.4]

eval ground(1.2, 2.4, 11.2)
eval floor_at(2.4, 1.2, 23.5)
eval spring(1.2, 5, 8.8, 0.5)
eval text(3.1, 10.0, "K")
eval damper(1.2, 5, 5.2, 0.5)
eval text(3.1, 6.4, "C")

# The primary mass, its cavity, and its compliant walls.
eval block(5, 3.2, 20, 11.2, "#D8D8D8")
eval block(6.6, 4.6, 18.4, 9.8, "#FFFFFF")
do for [x in "7 10.5 14.5 18"] { eval wheel(x + 0, 2.8, 0.4) }
eval text(12.5, 3.85, "M")
eval spring(6.6, 8.6, 7.35, 0.3)
eval damper(6.6, 8.6, 5.75, 0.3)
eval line(8.6, 5.1, 8.6, 8)
eval text(7.55, 8.25, "K_M")
eval text(7.55, 6.55, "C_M")
eval spring(18.4, 16.4, 7.35, 0.3)
eval damper(18.4, 16.4, 5.75, 0.3)
eval line(16.4, 5.1, 16.4, 8)
eval text(17.45, 8.25, "K_M")
eval text(17.45, 6.55, "C_M")

# The secondary mass.
eval block(11.2, 4.6, 14, 8, "#BFD9EA")
eval text(12.6, 6.3, "m")
eval pointing(8.6, 5.6, 11.2, 5.6)
eval text(9.8, 6.2, "Y")
eval thin(11.2, 8, 11.2, 9.4)
eval pointing(11.2, 8.9, 13.4, 8.9)
eval text(14, 8.95, "Z")

eval thin(5, 11.2, 5, 14)
eval pointing(5, 13.4, 7.4, 13.4)
eval text(8.1, 13.45, "X")
eval pointing(20, 7.2, 23, 7.2)
eval text(21.6, 8, "F(T)")

# Measures: wall thickness, cavity width, width of the secondary mass.
do for [x in "8.6 16.4"] { eval thin(x + 0, 8, x + 0, 12.6) }
eval measure(8.6, 16.4, 12.2)
eval text(12.5, 12.8, "D")
eval measure(5, 8.6, 12.2)
eval text(6.8, 12.8, "A")
do for [x in "11.2 14"] { eval thin(x + 0, 4.6, x + 0, 0.9) }
eval measure(11.2, 14, 1.1)
eval text(12.6, 0.5, "d")
plot NaN notitle
