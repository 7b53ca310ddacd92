#!/bin/bash
# What a class costs on many machines: a model of few terms. Each term is measured on small classes, the model then
# predicts larger ones, and they are measured too; its last lines are 10^5 submissions on 10^3 cores.
#   tests/cluster/cost_model.sh ROOT [FOLDER]
# CPU time is compared, not the time on the wall, so that it may run beside other work. Needs ROOT/build with what
# `tumble grade a1` needs, GNU parallel and python3. Ten minutes of one core.
set -euo pipefail
root=$(realpath "$1") folder=${2:-$(mktemp -d /tmp/cost_model.XXXXXX)}
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
tumble=$root/build/bin/tumble
export TUMBLE_ROOT=$root TUMBLE_GRADER_KEY=$folder/grader.key
mkdir -p "$folder"

# measure WORDS...: sets cpu [s] of the program and its children, wall [s], and most [MiB],
# the largest memory of the program itself (what it starts, pandoc say, may need more).
measure() {
  read -r cpu wall most < <(python3 - "$folder/printed.txt" "$@" <<'PY'
import resource, subprocess, sys, time
began = time.time()
most = 0
with open(sys.argv[1], "w") as printed:
    program = subprocess.Popen(sys.argv[2:], stdout=printed, stderr=printed)
    while program.poll() is None:
        with open(f"/proc/{program.pid}/status") as status:
            for line in status:
                if line.startswith("VmHWM:"):
                    most = max(most, int(line.split()[1]))
        time.sleep(0.01)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, time.time() - began, most / 1024)
PY
  )
}
grade() { measure "$tumble" grade a1 "$folder/$1" --out "$folder/$1-out" --no-media --jobs 1 "${@:2}"; }
calc() { awk "BEGIN {printf \"%.6g\", $*}"; }
# An empty folder a student: what a submission costs beside compiling and judging.
empty_class() { (mkdir -p "$folder/$1" && cd "$folder/$1" && seq -f 'student_%06g' "$2" | xargs mkdir -p); }
# check WHAT PREDICTED MEASURED UNIT
check() { awk -v what="$1" -v p="$2" -v m="$3" -v unit="$4" 'BEGIN {printf "  %-58s %10.4g %10.4g %-8s %+5.0f %%\n", what, p, m, unit, 100 * (p / m - 1)}'; }

# ---- terms, on small classes
empty_class e1 1
grade e1 --shard 1/1
start=$cpu
empty_class e40 40
grade e40 --shard 1/1
page=$(calc "($cpu - $start) / 39")
grade e40
head40=$cpu memory40=$most
empty_class e160 160
grade e160 --shard 1/1
grade e160
head=$(calc "($cpu - $head40) / 120") memory=$(calc "($most - $memory40) / 120")
head0=$(calc "$head40 - 40 * $head") memory0=$(calc "$memory40 - 40 * $memory")
empty_class e20000 20000
grade e20000 --shard 1/20000
list=$(calc "($cpu > $start ? ($cpu - $start) / 20000 : 0)")
"$here/make_class.sh" "$root" "$folder/r4" 4
grade r4 --shard 1/1
judge=$(calc "($cpu - $start) / 4")
storage=$(calc "$(du -sk "$folder/r4-out/.shards" | cut -f1) / 4")
files=$(calc "$(find "$folder/r4-out/.shards" -mindepth 2 | wc -l) / 4")
grade r4
pages_of() { cat "$folder/$1-out"/{index,class}.html | wc -c; }
cat <<TERMS
terms, of a1 without pictures
  start of a shard             $(calc "1000 * $start") ms of CPU
  list, a submission of the class in each shard   $(calc "1e6 * $list") us
  compile and judge            $(calc "$judge") s a submission
  page of what has no file     $(calc "1000 * $page") ms a submission
  take over, pages of the class   $(calc "$head0") s + $(calc "1000 * $head") ms a submission, in one process
  memory of that process       $(calc "$memory0") MiB + $(calc "1024 * $memory") KiB a submission
  storage                      $(calc "$storage") KiB and $(calc "$files") files and folders a submission

  checked on larger classes                                   predicted   measured
TERMS

# ---- the model beside measured shards
"$here/make_class.sh" "$root" "$folder/r20" 20
grade r20 --on parallel --shards 5
check "20 submissions in 5 shards: CPU" "$(calc "5 * ($start + 20 * $list) + 20 * $judge + $head0 + 20 * $head")" "$cpu" s
check "  storage" "$(calc "20 * $storage")" "$(du -sk "$folder/r20-out" | cut -f1)" KiB
empty_class e800 800
for shard in 1 2 3 4 5 6 7 8; do
  grade e800 --shard "$shard/8"
  total=$(calc "${total:-0} + $cpu")
done
check "800 without a file in 8 shards: CPU" "$(calc "8 * ($start + 800 * $list + 100 * $page)")" "$total" s
grade e800
check "  the process that takes them over: CPU" "$(calc "$head0 + 800 * $head")" "$cpu" s
check "  its memory" "$(calc "$memory0 + 800 * $memory")" "$most" MiB

# ---- 10^5 submissions on 10^3 cores
n=100000 shards=1000
overview=$(calc "($(pages_of r20) - $(pages_of r4)) / 16")
cat <<END

  10^5 submissions in 10^3 shards, a core each
  shards                       $(calc "($start + $n * $list + $n / $shards * $judge) / 60") min
  then one process             $(calc "($head0 + $n * $head) / 60") min, $(calc "($memory0 + $n * $memory) / 1024") GiB of memory
  storage                      $(calc "$n * $storage / 1024 / 1024") GiB, $(calc "$n * $files / 1e6") million files and folders
  index.html and class.html    $(calc "$n * $overview / 1024 / 1024") MiB, if the matrix had every submission (it has 2,000 at most)
END
