/// Hostile submissions, one a file: what is attacked, the verdict that it must get, and how the
/// submission differs from a harmless one.
///
///   // attack: exit_in_a_call - ends its process with code 0 instead of returning
///   // kind: early exit
///   // verdict: crashed
///   // story: exit code 0
///   // run: sample
///   @@ before
///   #include <cstdlib>
///   @@ body intersect_ray_triangle
///   std::exit(0);
///
/// Words of the head, each `// word: value`, one a line; only the first three must be there:
///   attack   NAME - words. NAME is the file's name
///   kind     of the attack: a row of the table that `tumble attack` prints
///   verdict  of the tests that differ from the harmless submission's, or several with ", " between
///            them; "same": none differs, and among others: none needs to. With "right", an answer
///            that a test cannot tell from a right one is worth as much
///   state    judged (default), does not compile, or nothing to compile; several with ", " between
///            them, where it depends on the sandbox
///   module   an assignment; default a1
///   base     stub (default) or reference: the text that is changed
///   story    words that some story or note must hold; may stand several times
///   never    words that no page of it may hold; may stand several times
///   own points  what its own tests must earn (grades/own_tests.h), a number
///   folder   name of the submission, as a JSON string
///   not in   kinds of sandbox that do not promise to hold it, with spaces between them
///   needs    root, where only root can make the submission
///   media    yes: pictures and videos are made, too
///   run      sample: part of every test run
///
/// Parts, each begun by a line `@@ KIND [NAME]`:
///   before, after   text at the beginning or end of the base's file
///   body FUNCTION   text at the beginning of the body of this function of the base
///   whole           text that replaces the base's file
///   file NAME       another file of the submission, with this text
///   link, hard link, fifo, folder, device NAME
///                   a special file; the text of a link is what it leads to. Where NAME is the
///                   module's own file, it replaces that
///   fill NAME       a file of as many MB of spaces as the text says, followed by the base
/// In a text and in the name of a file, {{secret}} and the like are places of this run
/// (make_attack.h).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace tumble::grading {

struct AttackPart {
  enum class Kind {
    kBefore,
    kAfter,
    kBody,
    kWhole,
    kFile,
    kLink,
    kHardLink,
    kFifo,
    kFolder,
    kDevice,
    kFill
  };
  Kind kind;
  std::string name;  // of a function or file; may be empty
  std::string text;
  int line;  // of its @@, from 1
};

struct Attack {
  std::filesystem::path file;
  std::string name, about, kind;
  std::set<std::string> verdicts;  // words(Verdict) and "same"
  std::set<std::string> states;    // one of them
  std::string module = "a1";
  std::string base = "stub";
  std::vector<std::string> stories, never;
  std::optional<double> own_points;
  std::string folder;  // any bytes but '/' and NUL
  std::set<std::string> not_in;
  bool needs_root = false, media = false, is_sample = false;
  std::vector<AttackPart> parts;

  /// The harmless submission that it is compared with, test by test: "stub"; "reference"; or the
  /// reference with stubs in place of the functions that are attacked, "without-F-G".
  std::string harmless() const;
  /// The functions of its `body` parts.
  std::vector<std::string> functions() const;
};

constexpr const char* kAttackExtension = ".attack";

/// @throws UserError with file and line for what is not written as above
Attack read_attack(const std::filesystem::path& file);

/// All of a folder, by name.
/// @throws UserError as read_attack does, and for a folder without any
std::vector<Attack> read_attacks(const std::filesystem::path& folder);

}  // namespace tumble::grading
