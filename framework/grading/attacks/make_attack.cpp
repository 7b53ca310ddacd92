#include "framework/grading/attacks/make_attack.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <fstream>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Kind = AttackPart::Kind;

constexpr unsigned kZeroMajor = 1, kZeroMinor = 5;  // /dev/zero

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw UserError(file.string(), "cannot be written");
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void fill(const fs::path& file, const std::string& megabytes, const std::string& base) {
  std::ofstream out(file, std::ios::binary);
  const std::string block(1 << 20, ' ');
  for (int i = 0; i < std::stoi(megabytes); ++i) out << block;
  out << '\n' << base;
}

// A file that is no text of C++.
void make_special(const AttackPart& part, const fs::path& file, const std::string& text,
                  const std::string& base) {
  fs::create_directories(file.parent_path());
  const std::string to = first_line(text);
  switch (part.kind) {
    case Kind::kLink: fs::create_symlink(to, file); break;
    case Kind::kHardLink: fs::create_hard_link(to, file); break;
    case Kind::kFifo: require(::mkfifo(file.c_str(), 0666) == 0, "mkfifo"); break;
    case Kind::kFolder: fs::create_directories(file); break;
    case Kind::kDevice:
      require(::mknod(file.c_str(), S_IFCHR | 0666, makedev(kZeroMajor, kZeroMinor)) == 0,
              "a device can be made by root only");
      break;
    case Kind::kFill: fill(file, to, base); break;
    default: write(file, text);
  }
}

bool changes_source(Kind kind) {
  return kind == Kind::kBefore || kind == Kind::kAfter || kind == Kind::kBody ||
         kind == Kind::kWhole;
}

}  // namespace

std::string with_places(std::string text, const AttackPlaces& places, const std::string& where) {
  for (std::size_t from = 0; (from = text.find("{{", from)) != std::string::npos;) {
    const std::size_t end = text.find("}}", from);
    const std::string word = text.substr(from + 2, end == std::string::npos ? 0 : end - from - 2);
    // initialisers of C++ have the same braces
    if (word.empty() || word.find_first_not_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos) {
      from += 2;
      continue;
    }
    const auto place = places.find(word);
    std::vector<std::string> known;
    for (const auto& entry : places) known.push_back(entry.first);
    if (place == places.end())
      throw UserError(
          where, "{{" + word + "}} is no place",
          "They stand in framework/grading/attacks/make_attack.h." + did_you_mean(word, known));
    text.replace(from, end + 2 - from, place->second);
    from += place->second.size();
  }
  return text;
}

std::string with_body(const std::string& text, const std::string& function,
                      const std::string& first, const std::string& where) {
  for (std::size_t at = 0; (at = text.find(" " + function + "(", at)) != std::string::npos; ++at) {
    const std::size_t line = text.rfind('\n', at) + 1, brace = text.find("{\n", at);
    const bool is_definition = text[line] != ' ' && text[line] != '/' && text[line] != '#';
    if (!is_definition || brace == std::string::npos) continue;
    return text.substr(0, brace + 2) + first + text.substr(brace + 2);
  }
  throw UserError(where, "the base defines no function " + function,
                  "It is looked for at the beginning of a line.");
}

void make_attack(const Attack& attack, const std::string& base_text, const std::string& source_name,
                 const AttackPlaces& places, const fs::path& folder) {
  fs::create_directories(folder);
  std::string source = base_text;
  bool has_source = true;
  for (const AttackPart& part : attack.parts) {
    const std::string where = attack.file.string() + ":" + std::to_string(part.line),
                      text = with_places(part.text, places, where);
    if (part.kind == Kind::kBefore) source = text + source;
    if (part.kind == Kind::kAfter) source += text;
    if (part.kind == Kind::kWhole) source = text;
    if (part.kind == Kind::kBody) source = with_body(source, part.name, text, where);
    if (changes_source(part.kind)) continue;
    const std::string name = with_places(part.name, places, where);
    if (name == source_name) has_source = false;
    try {
      make_special(part, folder / name, text, base_text);
    } catch (const std::exception& error) {
      throw UserError(where, std::string("cannot be made: ") + error.what());
    }
  }
  if (has_source) write(folder / source_name, source);
}

}  // namespace tumble::grading
