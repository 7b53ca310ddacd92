#include "framework/grading/course/release_checks.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <regex>
#include <string_view>
#include <unordered_map>

#include "framework/core/code_text.h"
#include "framework/core/files.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// Shortest sequences of tokens that count as a copy: signatures, loops and idioms are shorter.
// Hidden tests share whole fixtures and scenes with public ones.
constexpr std::size_t kSolutionTokens = 50, kTestTokens = 200;
// Three consecutive lines of code are a copy; fewer lines, or fewer characters, are common idiom.
constexpr std::size_t kLinesInARow = 3, kLeastCharacters = 80;
constexpr std::size_t kMostBytes = 4u << 20;  // of a file that is text

bool is_text(const std::string& bytes) {
  return bytes.size() < kMostBytes && bytes.find('\0') == std::string::npos;
}
bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
int line_at(const std::string& text, std::size_t at) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}
std::string at_line(const std::string& file, int line) { return file + ":" + std::to_string(line); }

struct Token {
  std::uint64_t hash;
  int line;
};

std::vector<Token> tokens_of(const std::string& code) {
  std::vector<Token> tokens;
  int line = 1;
  for (std::size_t i = 0; i < code.size();) {
    if (code[i] == '\n') ++line;
    if (std::isspace(static_cast<unsigned char>(code[i])) != 0) {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (is_word(code[i]) && end < code.size() && is_word(code[end])) ++end;
    tokens.push_back(
        {std::hash<std::string_view>{}(std::string_view(code).substr(i, end - i)), line});
    i = end;
  }
  return tokens;
}

/// Calls visit(hash, line) for each sequence of n tokens.
template <class Visit>
void each_row(const std::vector<Token>& tokens, std::size_t n, const Visit& visit) {
  for (std::size_t i = 0; i + n <= tokens.size(); ++i) {
    std::uint64_t hash = n;
    for (std::size_t k = i; k < i + n; ++k)
      hash = (hash ^ tokens[k].hash) * 0x9e3779b97f4a7c15ull + (hash >> 29);
    visit(hash, tokens[i].line);
  }
}

/// Calls visit(hash, line) for each kLinesInARow consecutive lines of code, without indentation,
/// comments, includes and lines of braces only.
template <class Visit>
void each_passage(const std::string& text, const Visit& visit) {
  std::vector<std::pair<std::string, int>> lines;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    ++number;
    const std::size_t end = std::min(text.find('\n', begin), text.size()),
                      first = text.find_first_not_of(" \t", begin);
    if (first < end) {
      const std::string line = text.substr(first, end - first);
      if (line.size() > 2 && !line.starts_with("//") && !line.starts_with("#") &&
          !line.starts_with("}  // namespace"))
        lines.emplace_back(line, number);
    }
    begin = end + 1;
  }
  for (std::size_t i = 0; i + kLinesInARow <= lines.size(); ++i) {
    std::string passage;
    for (std::size_t k = i; k < i + kLinesInARow; ++k) passage += lines[k].first + '\n';
    if (passage.size() >= kLeastCharacters)
      visit(std::hash<std::string>{}(passage), lines[i].second);
  }
}

// hash of a text -> "solutions_private/file:line"
using Origins = std::unordered_map<std::uint64_t, std::string>;

/// Hashes of everything that must not be shipped.
struct Secrets {
  Origins files, passages, solution_rows, test_rows;
};

Secrets collect(const std::vector<PrivateFile>& secrets) {
  Secrets all;
  for (const PrivateFile& secret : secrets) {
    const auto place = [&](int line) {
      return secret.places.empty() ? at_line(secret.file.string(), line)
                                   : secret.places[static_cast<std::size_t>(line) - 1];
    };
    all.files.emplace(std::hash<std::string>{}(secret.text), secret.file.string());
    if (!is_text(secret.text)) continue;
    const std::vector<Token> tokens = tokens_of(code_of(secret.text));
    each_row(tokens, secret.is_test ? kTestTokens : kSolutionTokens,
             [&](std::uint64_t hash, int line) {
               (secret.is_test ? all.test_rows : all.solution_rows).emplace(hash, place(line));
             });
    if (!secret.is_test)
      each_passage(secret.text,
                   [&](std::uint64_t hash, int line) { all.passages.emplace(hash, place(line)); });
  }
  return all;
}

bool is_module_header(const fs::path& file) {
  auto part = file.begin();
  return file.extension() == ".h" && part != file.end() && *part == "assignments";
}

void forget_headers(const fs::path& folder, const std::vector<fs::path>& shipped,
                    Secrets& secrets) {
  for (const fs::path& file : shipped) {
    if (!is_module_header(file)) continue;
    const std::string text = text_of(folder / file);
    const std::vector<Token> tokens = tokens_of(code_of(text));
    each_row(tokens, kSolutionTokens,
             [&](std::uint64_t hash, int) { secrets.solution_rows.erase(hash); });
    each_passage(text, [&](std::uint64_t hash, int) { secrets.passages.erase(hash); });
  }
}

/// The first place of a file with a secret.
std::optional<ReleaseFault> first_leak(const std::string& name, const std::string& text,
                                       const Secrets& secrets) {
  if (const auto whole = secrets.files.find(std::hash<std::string>{}(text));
      whole != secrets.files.end() && !text.empty())
    return ReleaseFault{name, "is a copy of " + whole->second};
  if (!is_text(text)) return std::nullopt;
  std::optional<ReleaseFault> found;
  const auto match = [&](const Origins& origins, std::uint64_t hash, int line,
                         const std::string& what) {
    if (found) return;
    if (const auto it = origins.find(hash); it != origins.end())
      found = ReleaseFault{at_line(name, line), "holds " + what + " of " + it->second};
  };
  each_passage(text, [&](std::uint64_t hash, int line) {
    match(secrets.passages, hash, line, "three lines");
  });
  const std::vector<Token> tokens = tokens_of(code_of(text));
  each_row(tokens, kSolutionTokens, [&](std::uint64_t hash, int line) {
    match(secrets.solution_rows, hash, line, "a passage");
  });
  each_row(tokens, kTestTokens, [&](std::uint64_t hash, int line) {
    match(secrets.test_rows, hash, line, "a passage");
  });
  return found;
}

/// Position of `name` as a separate word; npos: nowhere.
std::size_t find_name(const std::string& text, const std::string& name) {
  for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos; ++at) {
    const bool begins = at == 0 || !is_word(text[at - 1]),
               ends = at + name.size() == text.size() || !is_word(text[at + name.size()]);
    if (begins && ends) return at;
  }
  return std::string::npos;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path().lexically_relative(folder));
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<ReleaseFault> missing_files(const fs::path& root, const std::vector<fs::path>& shipped,
                                        const std::vector<fs::path>& left_out) {
  // names that any text may contain
  constexpr std::array kEverywhere = {"README.md", "CMakeLists.txt", "index.html"};
  std::vector<std::pair<std::string, std::string>> texts;
  for (const fs::path& file : shipped)
    if (std::string text = text_of(root / file); is_text(text))
      texts.emplace_back(file.string(), std::move(text));
  std::vector<ReleaseFault> found;
  for (const fs::path& file : left_out) {
    const std::string name = file.filename().string();
    if (std::find(kEverywhere.begin(), kEverywhere.end(), name) != kEverywhere.end()) continue;
    for (const auto& [user, text] : texts) {
      const std::size_t at = find_name(text, name);
      if (at == std::string::npos) continue;
      found.push_back(
          {at_line(user, line_at(text, at)),
           "needs " + file.string() + ", which is not released: git does not track it"});
      break;
    }
  }
  return found;
}

std::vector<ReleaseFault> what_is_no_stub(const std::string& name, const std::string& text,
                                          const std::vector<std::string>& functions) {
  std::vector<ReleaseFault> found;
  std::string code = code_of(text);
  const auto blank = [](std::string& where, const std::smatch& match) {  // places stay
    for (auto at = static_cast<std::size_t>(match.position(0)),
              end = at + static_cast<std::size_t>(match.length(0));
         at < end; ++at)
      if (where[at] != '\n') where[at] = ' ';
  };
  std::smatch m;
  for (const std::string& function : functions) {
    const std::regex stub(R"([\w:<>,&*\s]*\b)" + function +
                          R"(\s*\([^{};]*\)\s*\{\s*throw\s+NotImplemented\(\s*")" + function +
                          R"("\s*,\s*"[^"]*"\s*\)\s*;\s*\})");
    const std::string now = code;  // a match points into this copy
    if (std::regex_search(now, m, stub)) {
      blank(code, m);
      continue;
    }
    const std::size_t at = find_name(code, function);
    found.push_back({at == std::string::npos ? name : at_line(name, line_at(code, at)),
                     function +
                         " is not a stub: its body must be one line, throw NotImplemented(\"" +
                         function + "\", \"handouts/...\");"});
  }
  if (!found.empty()) return found;
  // Any other text than the namespace's own lines is more than stubs.
  static const std::regex space(R"(namespace [\w:]+ \{|\n\})");
  const std::string now = code;
  for (std::sregex_iterator it(now.begin(), now.end(), space), end; it != end; ++it)
    blank(code, *it);
  const std::size_t rest = code.find_first_not_of(" \t\r\n");
  if (rest != std::string::npos)
    found.push_back(
        {at_line(name, line_at(code, rest)),
         "holds more than stubs: " +
             code.substr(rest, std::min<std::size_t>(60, code.find('\n', rest) - rest))});
  return found;
}

std::vector<ReleaseFault> leaks(const fs::path& folder,
                                const std::vector<PrivateFile>& private_files) {
  const std::vector<fs::path> shipped = files_below(folder);
  Secrets secrets = collect(private_files);
  forget_headers(folder, shipped, secrets);
  std::vector<ReleaseFault> found;
  for (const fs::path& file : shipped)
    if (auto leak = first_leak(file.string(), text_of(folder / file), secrets))
      found.push_back(*leak);
  return found;
}

}  // namespace tumble::grading
