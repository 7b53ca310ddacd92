/// Known-wrong solutions written as slips: what differs from a right solution, and nothing else.
///
///   // mutant: area_doubled - twice the area of a triangle
///   // caught-by: the factor 1/2
///   // base: reference
///   @@ area_of_triangle
///      const Vector3d normal = ab.cross(ac);
///   -  return 0.5 * normal.norm();
///   +  return normal.norm();
///
/// The third line names the right solution: `reference`, or a file in alternatives/ without its
/// `.cpp`. A line that begins with `@@` begins a block; what follows on that line is for the
/// reader. Below it, the first column says what becomes of a line, as in `diff -u`: a space keeps
/// it, `-` takes it out, `+` puts it in. The lines kept and taken out must stand in the base one
/// below the other, and nowhere else. `diff -U1 BASE COPY | tail -n +3` prints the blocks of a
/// changed copy.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace tumble::grading {

/// What the first two lines of every known-wrong solution say, whole or slip.
struct SlipTitle {
  std::string name;
  std::string slip;     // what is wrong
  std::string keyword;  // words that the story of a test that catches it must hold
};

/// @throws UserError when the first two lines are not `// mutant: NAME - slip` and `// caught-by:
///         words`
SlipTitle read_slip_title(const std::filesystem::path& file);

struct SlipLine {
  enum class Kind { kKept, kTakenOut, kPutIn };
  Kind kind;
  std::string text;  // without its mark
  int line;          // in the slip's file, from 1
};

struct SlipBlock {
  int line;  // of its @@, from 1
  std::vector<SlipLine> lines;

  /// The text that the base must hold exactly once, line by line.
  std::vector<std::string> base_text() const;
};

struct Slip {
  std::filesystem::path file;
  SlipTitle title;
  std::string base;  // as the slip names it
  std::vector<SlipBlock> blocks;
};

constexpr const char* kSlipExtension = ".slip";

/// @throws UserError with file and line for what is not written as above
Slip read_slip(const std::filesystem::path& file);

/// The right solution that a slip changes.
/// @param solutions  of its assignment: solutions_private/aN_name
/// @throws UserError for a name that no right solution has, with the nearest
std::filesystem::path base_of(const Slip& slip, const std::filesystem::path& solutions);

/// The whole wrong solution that a slip makes of its base.
struct MadeSolution {
  struct Origin {
    bool is_of_slip;  // else of the base
    int line;         // there, from 1
  };
  std::filesystem::path slip, base;
  std::string text;
  std::vector<Origin> origins;  // by line of `text`
  std::set<int> taken_out;      // lines of the base that are not in `text`
};

/// @param base_file  for people: its text is `base_text`
/// @throws UserError with file and line for a block whose text the base does not hold, or holds
///         twice, and for two blocks that share a line of the base
MadeSolution make_solution(const Slip& slip, const std::filesystem::path& base_file,
                           const std::string& base_text);

/// Reads the slip and its base, and puts them together.
/// @throws UserError as read_slip, base_of and make_solution do
MadeSolution make_solution(const std::filesystem::path& slip_file,
                           const std::filesystem::path& solutions);

/// A compiler's story about the made text, with places in the slip or in its base: whoever mends
/// the slip finds them there.
/// @param compiled  the name of the file that the compiler read
std::string in_places_of_slip(const std::string& story, const std::string& compiled,
                              const MadeSolution& made);

}  // namespace tumble::grading
