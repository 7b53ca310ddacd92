#!/usr/bin/env bash
# The figures of the handouts: pictures and plots of runs with the reference solutions, and the drawings of handouts/drawings. The same tree gives the same bytes, but for the figures of CPU times.
# Usage: make_figures.sh [FOLDER]     FOLDER: where they are put; default: handouts/figures, which is what the repository shows
set -euo pipefail
folder=$(realpath -m "${1:-$(dirname "${BASH_SOURCE[0]}")/figures}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p "$folder"
for scene in collide_off_centre_e05 bullet_thin_wall t_handle; do
  ./tumble run "$scene" --modules a1=reference,a2=reference --sheet "$folder/$scene.png"
done
./tumble run newtons_cradle_springs --modules a1=reference,a2=reference,a3=reference --sheet "$folder/newtons_cradle_springs.png"
./tumble run arch --modules a1=reference,a2=reference,a3=reference --png "$folder/arch.png"
./tumble run cradle_in_flight --modules a1=reference,a4=reference --virtual-times "$folder/cradle_in_flight.png" --moves 38,46,51 --chart-until-s 1
./tumble run late_hit --modules a1=reference,a4=reference --virtual-times "$folder/late_hit_found.png" --moves 12,14 --chart-until-s 1.2
./tumble run late_hit --modules a1=reference,a4=reference --virtual-times "$folder/late_hit_undone.png" --moves 15,18,26,28 --chart-until-s 1.3

# A plot of a page: its own folder, since a page has several.
pages=$(mktemp -d)
trap 'rm -rf "$pages"' EXIT
sampled() { ./tumble sample "$@" --out "$pages" || [ $? = 1 ]; }   # 1: too few samples for answers; enough for a picture
sampled ball_into_bin --modules a1=reference,a2=reference,a5=reference
cp "$pages/ball_into_bin/worlds.png" "$folder/worlds_of_the_ball.png"
sampled bowling_split --samples 60 --warm-up 40 --modules a1=reference,a2=reference,a3=reference,a5=reference
cp "$pages/bowling_split/worlds.png" "$folder/worlds_of_the_split.png"
# Drawings (handouts/drawings), twice as large as they stand on a page.
build=${TUMBLE_BUILD:-build}
cmake --build "$build" --target draw_handouts >&2
mkdir "$pages/drawings"
"$build/bin/draw_handouts" "$pages/drawings"
for drawing in "$pages"/drawings/*.svg; do
  rsvg-convert --zoom 2 "$drawing" -o "$folder/$(basename "$drawing" .svg).png"
done

plot_of() { # PAGE PLOT FIGURE
  ./tumble plots "$pages/$1/index.html" --out "$pages/$1/plots"
  cp "$pages/$1/plots/$2.png" "$folder/$3.png"
}
./tumble cost t_handle --methods euler,midpoint,rk4 --engines none --steps 1/60,1/120,1/240,1/480,1/960,1/1920 --duration-s 2 --modules reference --out "$pages"
plot_of t_handle error_against_evaluations accuracy_and_its_price
./tumble cost double_pendulum --methods none --engines none --stabilisations none,baumgarte,projection --steps 1/30,1/60,1/120,1/240,1/480,1/960,1/1920 --modules reference --out "$pages"
plot_of double_pendulum error_against_the_step stabilisation_and_its_worth
# times are this machine's, so these two figures differ from run to run
./tumble cost chain_8 --methods rk4,fehlberg78 --engines none --duration-s 1 --modules reference --out "$pages"
plot_of chain_8 error_against_cpu_time rows_and_joint_coordinates
./tumble cost a5 --modules reference --out "$pages"
plot_of a5 error_of_an_answer_against_cpu_time what_a_chain_costs
./tumble engines atoms --sizes 10,20,40,80,160 --duration-s 1 --modules reference --out "$pages"
plot_of atoms work_per_body_and_simulated_second work_of_three_engines
