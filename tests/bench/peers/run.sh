#!/bin/bash
# Tumble beside Bullet, ODE, MuJoCo, Simbody and DART: scenes S1 to S8, error against CPU time, one page.
#   usage: tests/bench/peers/run.sh [--quick] [--cases S1,S5] [--engines tumble,ode] [--runs N] [--cap-s S] [--build DIR]
# Writes out/peers/index.html, and the rows it is made of to out/peers/rows. A peer that is not installed is named and left out:
# apt-get install $(sed 's/#.*//' tests/bench/peers/packages.txt). Rows of engines and cases that this run leaves out stay as they were.
set -euo pipefail
cd "$(dirname "$0")/../../.."
build=build quick= engines=tumble,ode,bullet,mujoco,simbody,dart words=()
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=--quick; words+=(--quick --runs 1 --cap-s 5) ;;
    --build) build=$2; shift ;;
    --engines) engines=$2; shift ;;
    --cases | --runs | --cap-s) words+=("$1" "$2"); shift ;;
    *) echo "run.sh: unknown word $1" >&2; sed -n 3p "$0" | cut -c3- >&2; exit 2 ;;
  esac
  shift
done
out=out/peers; [ -z "$quick" ] || out=out/peers_quick
mkdir -p "$out/rows"
TUMBLE_TREE=$(git describe --always --dirty 2> /dev/null || echo "no commit"); export TUMBLE_TREE
cmake -S . -B "$build" -G Ninja -DTUMBLE_PEERS=ON > "$out/configure.log" || { tail -5 "$out/configure.log" >&2; exit 2; }
ninja -C "$build" bench_peers > "$out/build.log" || { grep -m5 -E 'error|FAILED' "$out/build.log" >&2; exit 2; }
for engine in ${engines//,/ }; do
  program=$build/bin/peer_$engine
  if ! ninja -C "$build" -t query "peer_$engine" > /dev/null 2>&1; then
    case $engine in
      dart) echo "run.sh: DART is not there; it goes on without. tests/bench/peers/packages.txt says how to get it" >&2 ;;
      *) echo "run.sh: $engine is not there; it goes on without: apt-get install lib$engine-dev" >&2 ;;
    esac
    continue
  fi
  "$program" --out "$out/rows/$engine.part" ${words[@]+"${words[@]}"}
  if [ -e "$out/rows/$engine.tsv" ]; then   # rows of cases that were not asked for stay
    awk -F'\t' 'NR == FNR { seen[$1] = 1; next } !($1 in seen)' "$out/rows/$engine.part" "$out/rows/$engine.tsv" > "$out/rows/$engine.kept"
    cat "$out/rows/$engine.kept" >> "$out/rows/$engine.part"; rm "$out/rows/$engine.kept"
  fi
  mv "$out/rows/$engine.part" "$out/rows/$engine.tsv"
done
"$build/bin/peers_page" "$out/rows" "$out/index.html" $quick
echo "$out/index.html"
