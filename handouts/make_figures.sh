#!/usr/bin/env bash
# The pictures of the handouts, drawn by the framework with the reference solutions. The same tree gives the same bytes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
for scene in collide_off_centre_e05 bullet_thin_wall t_handle; do
  ./tumble run "$scene" --modules a1=reference,a2=reference --sheet "handouts/figures/$scene.png"
done
./tumble run newtons_cradle_springs --modules a1=reference,a2=reference,a3=reference --sheet handouts/figures/newtons_cradle_springs.png
./tumble run arch --modules a1=reference,a2=reference,a3=reference --png handouts/figures/arch.png
