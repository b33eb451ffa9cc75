# gnuplot -c docs/bench/plot.gp NAME.csv NAME.png: nanoseconds a particle by phase, one thread, one panel a precision and size.
if (ARGC != 2) { print "usage: gnuplot -c plot.gp NAME.csv NAME.png"; exit status 2 }
table = ARG1
set datafile separator ","
set style data histograms
set style histogram rowstacked
set style fill solid 0.85 border -1
set boxwidth 0.7
set yrange [0:*]
set grid ytics
set ylabel "ns a particle and step"
set xtics rotate by -30
set key outside right top
# Columns: 1 label, 5 precision, 6 threads, 7 particles, 11 … phases.
sizes = system(sprintf("tail -n +2 '%s' | cut -d, -f7 | sort -nu", table))
precisions = system(sprintf("tail -n +2 '%s' | cut -d, -f5 | sort -u", table))
threads = system(sprintf("tail -n +2 '%s' | cut -d, -f6 | sort -nu | head -1", table))
phases = "sort p2g grid g2p measure other"
set terminal pngcairo size 700 * words(sizes), 450 * words(precisions) font "sans,10" noenhanced # labels have underscores
set output ARG2
set multiplot layout words(precisions), words(sizes) title table
do for [p = 1:words(precisions)] {
    do for [n = 1:words(sizes)] {
        rows = sprintf("< awk -F, '$5 == \"%s\" && $6 == %s && $7 == %s' '%s'", word(precisions, p), threads, word(sizes, n), table)
        set title sprintf("%s, %s particles, %s thread(s)", word(precisions, p), word(sizes, n), threads)
        plot for [k = 1:6] rows using (column(10 + k)):xtic(1) title word(phases, k)
    }
}
unset multiplot
