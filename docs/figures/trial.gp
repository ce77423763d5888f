# One trial of one virtual subject, as docs/model.md shows it. From the project's root:
#   build/release/bin/thimble study --subjects 1 --no-control --trajectories --out out/one
#   gnuplot -c docs/figures/trial.gp out/one/trajectories docs/figures/trial.svg
folder = ARG1
cf = folder . '/experiment3_subject01_trial04_CF_50ms.csv'
hf = folder . '/experiment3_subject01_trial01_HF_50ms.csv'
set terminal svg size 1160,350 font 'DejaVu Sans,Helvetica,Arial,sans-serif,13' linewidth 1.2 background 'white'
# A browser shows each <title> under the pointer.
set output "| sed 's,<title>[^<]*</title>,,' > '" . ARG2 . "'"
set datafile separator comma
set datafile commentschars '#'
set border 3 linecolor '#444444'
set tics nomirror out scale 0.6
set xlabel 'time (s)'

# The fixture's place, from any sample that touches it: F = -K (z_n - z_vf), K = 3000 N/m.
stats cf using ($5 < 0 ? $2 + $5 / 3000 : NaN) name 'cf' nooutput
stats hf using ($5 < 0 ? $2 + $5 / 3000 : NaN) name 'hf' nooutput

set multiplot
set lmargin at screen 0.055; set rmargin at screen 0.29; set bmargin at screen 0.2; set tmargin at screen 0.88
set border 11; set ytics nomirror; set y2tics 10 nomirror
set xrange [0:1.4]; set yrange [0:60]; set y2range [-40:20]
set ylabel 'position (mm)' offset 1; set y2label 'tissue force on the operator (mN)' offset -1.5
set title 'touch and puncture'
set key top left samplen 2
plot cf using 1:(1000 * $2) every 4 with lines linewidth 2 linecolor '#D55E00' title 'needle', \
     cf using 1:(1000 * $3) every 4 with lines linewidth 2 linecolor '#0072B2' title 'tissue surface', \
     cf using 1:(1000 * $4) every 4 axes x1y2 with lines linewidth 1.5 linecolor '#999999' title 'force (right)'
unset y2tics; unset y2label; set border 3

set xrange [0:26]; set yrange [-60:30]
unset key
set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead dashtype (6,4) linecolor 'black' back
set ylabel 'needle beyond the fixture (mm)' offset 1
set lmargin at screen 0.425; set rmargin at screen 0.69
set title 'CF, 50 ms: an overshoot, then rest'
plot cf using 1:(1000 * ($2 - cf_mean)) every 8 with lines linewidth 1.5 linecolor '#D55E00'
unset ylabel
set lmargin at screen 0.73; set rmargin at screen 0.99
set title 'HF, 50 ms: kicked out, again and again'
plot hf using 1:(1000 * ($2 - hf_mean)) every 8 with lines linewidth 1 linecolor '#D55E00'
unset multiplot
