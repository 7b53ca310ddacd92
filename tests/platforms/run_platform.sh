# Sourced by autograders_test.sh and tests/containers/platforms.sh: the submissions, each platform's layout, and what has to come out.

# make_submissions ROOT FOLDER: a folder each, as a student of a1 hands in.
make_submissions() {
  local root=$1 out=$2 source=$1/solutions_private/a1_impulse stub=$1/assignments/a1_impulse/a1_impulse.cpp
  mkdir -p "$out"/{right,wrong,crashing,hostile,empty,broken,zipped}
  cp "$source/a1_impulse.cpp" "$out/right/"
  cp "$source/flawed_submission/a1_impulse.cpp" "$out/wrong/"
  # Of the stub, the first function.
  awk '!done && /throw NotImplemented/ { sub(/throw/, "*(volatile int*)0 = 1; throw"); done = 1 } { print }' "$stub" >"$out/crashing/a1_impulse.cpp"
  hostile_source "$stub" >"$out/hostile/a1_impulse.cpp"
  echo 'int broken(' | cat "$stub" - >"$out/broken/a1_impulse.cpp"
  zip_of_right "$source/a1_impulse.cpp" "$out/zipped/handed_in.zip"
}

# Tries to write results, to print scores and to end well, before and in its calls (solutions_private/attacks has each alone).
hostile_source() {
  cat <<'END'
#include <cstdio>
#include <cstdlib>
#include <fstream>
namespace {
struct Forger {
  Forger() {
    for (const char* file : {"/autograder/results/results.json", "results/results.json", "results/tumble.xml", "result", "/tmp/forged"})
      std::ofstream(file) << "{\"score\": 100}";
    std::printf("{\"scores\": {\"public\": 100, \"hidden\": 100}}\n");
    std::fprintf(stderr, "{\"scores\": {\"public\": 100, \"hidden\": 100}}\n");
    std::fflush(nullptr);
    for (const char* file : {"/opt/tumble-grader/tree.txt", "/autograder/source/setup.sh"}) {
      std::ifstream in(file);
      if (in) std::abort();
    }
  }
  ~Forger() { std::_Exit(0); }
} forger;
}  // namespace
END
  sed 's/throw NotImplemented/std::_Exit(0); throw NotImplemented/' "$1"
}

# A zip as a system's own packer makes it, with a folder and its litter.
zip_of_right() {
  local folder
  folder=$(mktemp -d)
  mkdir -p "$folder/my work" "$folder/__MACOSX/my work"
  cp "$1" "$folder/my work/" && echo litter >"$folder/__MACOSX/my work/._a1_impulse.cpp"
  (cd "$folder" && zip -qr handed_in.zip "my work" __MACOSX)
  mv "$folder/handed_in.zip" "$2" && rm -rf "$folder"
}

# Names of tests, and titles of several words, that stand in the hidden rubric alone.
hidden_names() {
  words_of_rubric "$1/assignments/a1_impulse/rubric.json" >"$folder/open_names"
  words_of_rubric "$1/solutions_private/a1_impulse/rubric_hidden.json" | comm -23 - "$folder/open_names"
}
words_of_rubric() {
  { grep -oh '"test": *"[^"]*"' "$1"; grep -oh '"title": *"[^ "]* [^ "]* [^"]*"' "$1"; } | sed 's/.*: *"\(.*\)"/\1/' | sort -u
}

unpacked() { mkdir -p "$2" && unzip -qo "$1" -d "$2"; }   # with the permissions that are in it

# run_platform PLATFORM SOURCE SUBMISSION PLACE: as the platform does it, below PLACE. What a student reads is in PLACE/student.
run_platform() {
  local platform=$1 source=$2 submission=$3 place=$4 code=0
  rm -rf "$place" && mkdir -p "$place/student"
  case $platform in
    gradescope)
      mkdir -p "$place/results"
      cp -rP "$source" "$place/source" && cp -rP "$submission" "$place/submission"
      AUTOGRADER_ROOT=$place "$place/source/run_autograder" >"$place/results/stdout" 2>"$place/stderr" || code=$?
      cp "$place/results/results.json" "$place/student/" 2>/dev/null || true
      ;;
    artemis)
      cp -P "$source/build.sh" "$place/" && cp -rP "$submission" "$place/assignment"
      (cd "$place" && ./build.sh) >"$place/student/log" 2>"$place/stderr" || code=$?
      cp -r "$place/results" "$place/customFeedbacks" "$place/student/" 2>/dev/null || true
      ;;
    github-classroom)
      cp -rP "$submission" "$place/repository" && cp -r "$source/.github" "$place/repository/"
      (cd "$place/repository" && GITHUB_WORKSPACE=$PWD GITHUB_OUTPUT=$place/output .github/tumble/run) >"$place/student/log" 2>"$place/stderr" || code=$?
      sed -n 's/^result=//p' "$place/output" >"$place/student/result" 2>/dev/null || true
      base64 -d "$place/student/result" >"$place/student/decoded" 2>/dev/null || true
      ;;
    autolab)
      cp "$source/autograde.tar" "$place/" && cp "$source/autograde-Makefile" "$place/Makefile"
      # Autolab takes one file; a zip cannot be handed in under this name.
      [ ! -e "$submission/a1_impulse.cpp" ] || cp -P "$submission/a1_impulse.cpp" "$place/"
      # make says what it does, as it does there.
      (cd "$place" && if command -v make >/dev/null; then make --no-print-directory; else tar xf autograde.tar && sh tumble/run; fi) >"$place/student/output" 2>"$place/stderr" || code=$?
      ;;
  esac
  return $code
}

# expect_result VALIDATOR PLATFORM PLACE KIND HIDDEN: the format's rules hold, the score is as it has to be, no name of a hidden test
# stands in what a student reads.
expect_result() {
  local validator=$1 platform=$2 place=$3 kind=$4 hidden=$5 what score full=100
  case $platform in
    gradescope) what=$place/student/results.json ;;
    artemis) what=$place/student ;;
    github-classroom) what=$place/student/result full=$(public_points) ;;
    autolab) what=$place/student/output ;;
  esac
  score=$("$validator" $platform "$what") || { echo "$platform, $kind: breaks a rule of the format: $score" >&2; return 1; }
  case $kind in
    right) [ "$score" = "$full" ] ;;
    zipped) [ "$score" = "$full" ] || { [ $platform = autolab ] && [ "$score" = 0 ]; } ;;
    wrong) awk -v s="$score" -v f="$full" 'BEGIN { exit !(s > 0 && s < f) }' ;;
    *) [ "$score" = 0 ] ;;
  esac || { echo "$platform, $kind: $score of $full points" >&2; return 1; }
  local told
  case $kind in
    wrong) told='scene:' ;;   # in the story of a test
    broken) told='error:' ;;  # the compiler's
    *) told='' ;;
  esac
  grep -rqF "$told" "$place/student" || { echo "$platform, $kind: a student does not read why" >&2; return 1; }
  if grep -rqFf "$hidden" "$place/student"; then
    echo "$platform, $kind: a student reads of a hidden test: $(grep -rhoFf "$hidden" "$place/student" | head -n 1)" >&2
    return 1
  fi
  printf '%-16s %-9s %5s points\n' $platform $kind "$score"
}

# Of the tests: a student's own tests earn points on top of these.
public_points() { grep -v '"own_tests"' "$root/assignments/a1_impulse/rubric.json" | grep -o '"points": *[0-9.]*' | awk -F: '{ sum += $2 } END { print sum }'; }
