#include "framework/grading/course/slip.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <regex>
#include <sstream>
#include <string_view>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMutant = "// mutant: ", kCaughtBy = "// caught-by: ",
                           kBase = "// base: ";
constexpr std::string_view kBlock = "@@";
constexpr const char* kReference = "reference";
constexpr std::size_t kShownOfLine = 100;  // bytes of a line of code that a message quotes

std::string place_in(const fs::path& file, int line) {
  return file.string() + ":" + std::to_string(line);
}

std::string quoted_code(const std::string& line) {
  const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
  return "'" + line.substr(first, kShownOfLine) + "'";
}

/// Lines without their ends, of Unix or Windows.
std::vector<std::string> unix_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.ends_with('\r')) line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

SlipTitle slip_title_of(const fs::path& file, const std::string& first, const std::string& second) {
  const std::size_t dash = first.find(" - ");
  if (!first.starts_with(kMutant) || dash == std::string::npos || !second.starts_with(kCaughtBy))
    throw UserError(file.string(), "does not say which slip it makes",
                    "Its first two lines are:  // mutant: NAME - slip   and   "
                    "// caught-by: words of the story that names it");
  return {first.substr(kMutant.size(), dash - kMutant.size()), first.substr(dash + 3),
          second.substr(kCaughtBy.size())};
}

/// Reads what stands below the title.
class BlockReader {
 public:
  explicit BlockReader(const fs::path& file) : file_(file) {}

  void take(const std::string& line, int number) {
    if (line.starts_with(kBlock)) {
      end_block();
      blocks_.push_back({number, {}});
    } else if (line.starts_with('\\')) {
      // "\ No newline at end of file", which diff writes.
    } else if (blocks_.empty()) {
      take_before_first(line, number);
    } else {
      take_into_block(line, number);
    }
  }

  std::vector<SlipBlock> blocks() {
    if (blocks_.empty())
      throw UserError(file_.string(), "changes nothing: it holds no block",
                      "A block begins with a line @@; below it stand lines of the base, marked "
                      "' ' (kept), '-' (taken out) or '+' (put in).");
    end_block();
    return std::move(blocks_);
  }

 private:
  void take_before_first(const std::string& line, int number) const {
    const bool is_remark =
        line.find_first_not_of(" \t") == std::string::npos || line.starts_with("//");
    if (!is_remark)
      throw UserError(place_in(file_, number),
                      "stands before the first block: " + quoted_code(line),
                      "A block begins with a line @@.");
  }

  void take_into_block(const std::string& line, int number) {
    using Kind = SlipLine::Kind;
    // Editors take spaces off line ends: an empty line is a kept one that is empty.
    const char mark = line.empty() ? ' ' : line.front();
    if (mark != ' ' && mark != '-' && mark != '+')
      throw UserError(place_in(file_, number),
                      "has no mark in its first column: " + quoted_code(line),
                      "A line of a block begins with ' ' (kept), '-' (taken out) or '+' (put in).");
    const Kind kind = mark == ' ' ? Kind::kKept : mark == '-' ? Kind::kTakenOut : Kind::kPutIn;
    blocks_.back().lines.push_back({kind, line.empty() ? "" : line.substr(1), number});
  }

  void end_block() {
    using Kind = SlipLine::Kind;
    if (blocks_.empty()) return;
    auto& lines = blocks_.back().lines;
    const auto is_blank = [](const SlipLine& line) {
      return line.kind == Kind::kKept && line.text.empty();
    };
    while (!lines.empty() && is_blank(lines.back())) lines.pop_back();  // between two blocks
    const auto is_kept = [](const SlipLine& line) { return line.kind == Kind::kKept; };
    const auto is_put_in = [](const SlipLine& line) { return line.kind == Kind::kPutIn; };
    const std::string where = place_in(file_, blocks_.back().line);
    if (std::all_of(lines.begin(), lines.end(), is_kept))
      throw UserError(where, "a block that changes nothing",
                      "Mark what the slip takes out with '-', and what it puts in with '+'.");
    if (std::all_of(lines.begin(), lines.end(), is_put_in))
      throw UserError(
          where, "a block that does not say where its lines belong",
          "Put the line of the base before or after them into it, marked with a space.");
  }

  fs::path file_;
  std::vector<SlipBlock> blocks_;
};

/// Finds blocks in a base.
class BlockFinder {
 public:
  BlockFinder(const Slip& slip, const fs::path& base, const std::vector<std::string>& lines)
      : slip_(slip), base_(base), lines_(lines) {}

  /// @return the index of the block's first line in the base
  std::size_t place_of(const SlipBlock& block) const {
    const std::vector<std::string> wanted = block.base_text();
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i + wanted.size() <= lines_.size(); ++i)
      if (std::equal(wanted.begin(), wanted.end(), lines_.begin() + static_cast<std::ptrdiff_t>(i)))
        found.push_back(i);
    if (found.empty()) refuse_missing(block);
    if (found.size() > 1)
      throw UserError(place_in(slip_.file, block.line),
                      "the text of this block stands in its base more than once, at " +
                          place_in(base_, number(found[0])) + " and " +
                          place_in(base_, number(found[1])),
                      "Add kept lines until it stands there once.");
    return found.front();
  }

 private:
  static int number(std::size_t index) { return static_cast<int>(index) + 1; }

  [[noreturn]] void refuse_missing(const SlipBlock& block) const {
    const std::string remedy =
        "The base has changed since the slip was written, or the slip is "
        "not copied from it to the letter: write the slip again.";
    for (const SlipLine& line : block.lines) {
      if (line.kind == SlipLine::Kind::kPutIn) continue;
      if (std::find(lines_.begin(), lines_.end(), line.text) != lines_.end()) continue;
      throw UserError(place_in(slip_.file, line.line),
                      "this line stands nowhere in " + base_.string() + ": " +
                          quoted_code(line.text) + nearest(line.text),
                      remedy);
    }
    throw UserError(place_in(slip_.file, block.line),
                    "each line of this block stands in " + base_.string() +
                        ", but nowhere do they stand one below the other",
                    remedy);
  }

  std::string nearest(const std::string& line) const {
    const std::string text = nearest_word(line, lines_);
    if (text.empty()) return "";
    const auto at = std::find(lines_.begin(), lines_.end(), text) - lines_.begin();
    return "; the nearest is line " + std::to_string(at + 1) + ": " + quoted_code(text);
  }

  const Slip& slip_;
  const fs::path& base_;
  const std::vector<std::string>& lines_;
};

struct PlacedBlock {
  const SlipBlock* block;
  std::size_t begin, end;  // lines of the base
};

std::vector<PlacedBlock> placed_blocks(const Slip& slip, const fs::path& base,
                                       const std::vector<std::string>& lines) {
  const BlockFinder finder(slip, base, lines);
  std::vector<PlacedBlock> all;
  for (const SlipBlock& block : slip.blocks) {
    const std::size_t begin = finder.place_of(block);
    all.push_back({&block, begin, begin + block.base_text().size()});
  }
  std::sort(all.begin(), all.end(),
            [](const PlacedBlock& a, const PlacedBlock& b) { return a.begin < b.begin; });
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i].begin < all[i - 1].end)
      throw UserError(place_in(slip.file, all[i].block->line),
                      "shares " + place_in(base, static_cast<int>(all[i].begin) + 1) +
                          " with the block at line " + std::to_string(all[i - 1].block->line),
                      "Make one block of the two.");
  return all;
}

}  // namespace

SlipTitle read_slip_title(const fs::path& file) {
  std::ifstream in(file);
  std::string first, second;
  std::getline(in, first);
  std::getline(in, second);
  for (std::string* line : {&first, &second})
    if (line->ends_with('\r')) line->pop_back();
  return slip_title_of(file, first, second);
}

std::vector<std::string> SlipBlock::base_text() const {
  std::vector<std::string> text;
  for (const SlipLine& line : lines)
    if (line.kind != SlipLine::Kind::kPutIn) text.push_back(line.text);
  return text;
}

Slip read_slip(const fs::path& file) {
  const std::vector<std::string> lines = unix_lines(text_of(file));
  const auto line = [&](std::size_t i) { return i < lines.size() ? lines[i] : std::string(); };
  Slip slip{file, slip_title_of(file, line(0), line(1)), "", {}};
  if (!line(2).starts_with(kBase))
    throw UserError(place_in(file, 3), "does not name the right solution that the slip changes",
                    "The third line is:  // base: reference   or  // base: NAME   for "
                    "alternatives/NAME.cpp");
  slip.base = line(2).substr(kBase.size());
  BlockReader reader(file);
  for (std::size_t i = 3; i < lines.size(); ++i) reader.take(lines[i], static_cast<int>(i) + 1);
  slip.blocks = reader.blocks();
  return slip;
}

fs::path base_of(const Slip& slip, const fs::path& solutions) {
  const auto file_of = [&](const std::string& name) {
    return name == kReference ? solutions / (solutions.filename().string() + ".cpp")
                              : solutions / "alternatives" / (name + ".cpp");
  };
  std::vector<std::string> known = {kReference};
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(solutions / "alternatives", ignored))
    if (entry.path().extension() == ".cpp") known.push_back(entry.path().stem().string());
  std::sort(known.begin() + 1, known.end());
  if (std::find(known.begin(), known.end(), slip.base) != known.end()) return file_of(slip.base);
  std::string names;
  for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
  throw UserError(
      place_in(slip.file, 3),
      "there is no right solution '" + slip.base + "'." + did_you_mean(slip.base, known),
      "Known: " + names + ".");
}

MadeSolution make_solution(const Slip& slip, const fs::path& base_file,
                           const std::string& base_text) {
  const std::vector<std::string> lines = unix_lines(base_text);
  MadeSolution made{slip.file, base_file, "", {}, {}};
  const auto add = [&](const std::string& line, bool is_of_slip, int number) {
    made.text += line + '\n';
    made.origins.push_back({is_of_slip, number});
  };
  std::size_t at = 0;
  const auto keep_until = [&](std::size_t end) {
    for (; at < end; ++at) add(lines[at], false, static_cast<int>(at) + 1);
  };
  for (const PlacedBlock& here : placed_blocks(slip, base_file, lines)) {
    keep_until(here.begin);
    for (const SlipLine& line : here.block->lines) {
      if (line.kind == SlipLine::Kind::kPutIn)
        add(line.text, true, line.line);
      else if (line.kind == SlipLine::Kind::kKept)
        keep_until(at + 1);
      else
        made.taken_out.insert(static_cast<int>(++at));
    }
  }
  keep_until(lines.size());
  return made;
}

MadeSolution make_solution(const fs::path& slip_file, const fs::path& solutions) {
  const Slip slip = read_slip(slip_file);
  const fs::path base = base_of(slip, solutions);
  return make_solution(slip, base, text_of(base));
}

std::string in_places_of_slip(const std::string& story, const std::string& compiled,
                              const MadeSolution& made) {
  static const std::regex gutter(R"(^( *)(\d{1,7})( \|.*)$)"), digits(R"(^(\d{1,7})(.*)$)");
  const auto origin_of = [&](const std::string& number) -> std::optional<MadeSolution::Origin> {
    const std::size_t line = std::stoul(number);
    if (line < 1 || line > made.origins.size()) return std::nullopt;
    return made.origins[line - 1];
  };
  const std::string head = compiled + ":";
  std::string told;
  bool is_of_made = false;  // the excerpt that follows
  for (std::string line : unix_lines(story)) {
    std::smatch m;
    if (line.starts_with(head)) {
      is_of_made = true;
      const std::string rest = line.substr(head.size());
      const auto origin = std::regex_match(rest, m, digits) ? origin_of(m[1]) : std::nullopt;
      const fs::path& file = origin && !origin->is_of_slip ? made.base : made.slip;
      line = file.filename().string() + ":" +
             (origin ? std::to_string(origin->line) + m[2].str() : rest);
    } else if (std::regex_match(line, m, gutter)) {
      const auto origin = is_of_made ? origin_of(m[2]) : std::nullopt;
      if (origin) line = m[1].str() + std::to_string(origin->line) + m[3].str();
    } else if (line.find(": error: ") != std::string::npos ||
               line.find(": note: ") != std::string::npos ||
               line.find(": warning: ") != std::string::npos) {
      is_of_made = false;
    }
    told += line + '\n';
  }
  return told;
}

}  // namespace tumble::grading
