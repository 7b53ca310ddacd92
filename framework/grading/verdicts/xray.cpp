#include "framework/grading/verdicts/xray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace tumble::grading {
namespace {

// Relative: what a few dozen roundings leave, far below what a story calls wrong for another
// reason.
constexpr double kRoundOff = 1e-9;
constexpr std::size_t kNameWidth = 24;
constexpr int kDigits = 6;
constexpr std::string_view kXrayMark = "\n  x-ray:    ";

std::map<std::string, XrayOfCall>& xrays() {
  static std::map<std::string, XrayOfCall> all;
  return all;
}

std::string digits_of(double x, int digits) {
  if (std::isnan(x)) return "nan";  // its sign says nothing
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, x == 0.0 ? 0.0 : x);
  return text;
}

// As many digits as tell two values apart: an error of float's size does not show in six.
int digits_for(const VectorXd& a, const VectorXd& b) {
  if (is_near(a, b)) return kDigits;
  for (const int digits : {kDigits, 9, 12})
    if (shown(a, "", digits) != shown(b, "", digits)) return digits;
  return kDigits;  // neither is a number
}

std::string line_of(const std::string& name, const std::string& value) {
  std::string text = "\n            " + name;
  if (name.size() < kNameWidth) text.append(kNameWidth - name.size(), ' ');
  return text + "  " + value;
}

// The answer in words where it has some ("no hit"), else in numbers.
std::string words_of_answer(const Xray& xray, const VectorXd& answer, int digits = kDigits) {
  const std::string words = xray.words ? xray.words(answer) : "";
  return words.empty() ? shown(answer, xray.unit, digits) : words;
}

// Two vectors of as many numbers: each number below its own. Other texts stay as they are.
std::pair<std::string, std::string> one_below_the_other(const std::string& a,
                                                        const std::string& b) {
  const auto numbers_in = [](const std::string& text) {
    std::vector<std::string> parts;
    const std::size_t end = text.find(')');
    if (!text.starts_with('(') || end == text.npos) return parts;
    for (std::size_t at = 1; at < end;) {
      const std::size_t comma = std::min(text.find(", ", at), end);
      parts.push_back(text.substr(at, comma - at));
      at = comma + 2;
    }
    return parts;
  };
  const auto of_a = numbers_in(a), of_b = numbers_in(b);
  if (of_a.empty() || of_a.size() != of_b.size()) return {a, b};
  std::string first = "(", second = "(";
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const std::size_t width = std::max(of_a[i].size(), of_b[i].size());
    const std::string gap = i == 0 ? "" : ", ";
    first += gap + std::string(width - of_a[i].size(), ' ') + of_a[i];
    second += gap + std::string(width - of_b[i].size(), ' ') + of_b[i];
  }
  return {first + a.substr(a.find(')')), second + b.substr(b.find(')'))};
}

// Marks by terms. Different mistakes may give the same answer: each of them is named.
std::map<std::size_t, std::string> variants_found(const Xray& xray) {
  std::map<std::size_t, std::string> marks;
  for (const XrayVariant& variant : xray.variants) {
    if (!is_near(variant.answer, xray.found)) continue;
    std::string& mark = marks[variant.term];
    mark += (mark.empty() ? "" : ", or ") + variant.says;
  }
  bool is_first = true;
  for (auto& [term, mark] : marks) {
    mark = (is_first ? kComesOut : "or it comes out ") + mark;
    is_first = false;
  }
  return marks;
}

// The first term whose part of the answer is wrong. Terms before it that nobody sees, behind the
// last one that is right, may be wrong already.
std::map<std::size_t, std::string> first_wrong(const Xray& xray) {
  std::string unseen;
  for (std::size_t i = 0; i < xray.terms.size(); ++i) {
    const XrayTerm& term = xray.terms[i];
    if (term.found.size() == 0) {
      unseen += (unseen.empty() ? "" : ", ") + term.name;
      continue;
    }
    if (is_near(term.value, term.found)) {
      unseen.clear();
      continue;
    }
    const int digits = digits_for(term.value, term.found);
    const std::string yours = "yours is " + shown(term.found, term.unit, digits);
    if (unseen.empty()) return {{i, "the first wrong line: " + yours}};
    return {{i, "the first line that is seen to be wrong: " + yours +
                    "; the mistake may stand before it, in what nobody sees: " + unseen}};
  }
  return {};
}

// What can be said where no term is marked: a formula may have its terms in another order, or more
// than one of them wrong.
std::string why_no_mark(const Xray& xray) {
  const XrayTerm* last_right = nullptr;  // every term that is seen is right
  for (const XrayTerm& term : xray.terms)
    if (term.found.size() > 0) last_right = &term;
  if (last_right != nullptr)
    return "every line that is seen is right, to " + last_right->name +
           ": the mistake is in a line that nobody sees, or in how they are put together";
  return std::string("which line is wrong cannot be read from this answer") +
         (xray.variants.empty() ? "" : ": no frequent mistake in one line alone gives it");
}

}  // namespace

bool is_near(const VectorXd& a, const VectorXd& b) {
  if (a.size() != b.size() || !a.allFinite() || !b.allFinite()) return false;
  const double scale = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  return (a - b).cwiseAbs().maxCoeff() <= kRoundOff * scale;
}

std::string shown(const VectorXd& v, const std::string& unit, int digits) {
  std::string text = v.size() == 1 ? "" : "(";
  for (Eigen::Index i = 0; i < v.size(); ++i) text += (i > 0 ? ", " : "") + digits_of(v[i], digits);
  return text + (v.size() == 1 ? "" : ")") + (unit.empty() ? "" : ' ' + unit);
}

VectorXd numbers(double x) { return VectorXd::Constant(1, x); }

bool is_answered_rightly(const Xray& xray) {
  return is_near(xray.expected, xray.found) &&
         std::none_of(xray.terms.begin(), xray.terms.end(), [](const XrayTerm& term) {
           return term.is_asked && !is_near(term.value, term.found);
         });
}

std::string xray_in_words(const Xray& xray, bool is_answered) {
  if (is_answered && is_answered_rightly(xray)) return "";
  std::map<std::size_t, std::string> marks;
  if (is_answered) marks = variants_found(xray);
  if (is_answered && marks.empty()) marks = first_wrong(xray);
  std::string text = std::string(kXrayMark) + xray.equation;

  for (std::size_t i = 0; i < xray.terms.size(); ++i) {
    const XrayTerm& term = xray.terms[i];
    const bool is_marked = marks.contains(i);
    const int digits =
        is_marked && term.found.size() > 0 ? digits_for(term.value, term.found) : kDigits;
    text += line_of(term.name, shown(term.value, term.unit, digits));
    if (is_marked) text += "   <- " + marks[i];
  }
  if (is_answered && is_near(xray.expected, xray.found))  // a term before it is wrong
    return text +
           line_of(xray.answer, words_of_answer(xray, xray.found) + " found, as these lines give");
  const int digits = is_answered ? digits_for(xray.expected, xray.found) : kDigits;
  const auto [expected, found] =
      is_answered
          ? one_below_the_other(words_of_answer(xray, xray.expected, digits),
                                words_of_answer(xray, xray.found, digits))
          : std::pair(words_of_answer(xray, xray.expected, digits), std::string("no answer"));
  text += line_of(xray.answer + ", expected", expected) + line_of(xray.answer + ", found", found);
  return is_answered && marks.empty() ? text + "   <- " + why_no_mark(xray) : text;
}

bool add_xray(const std::string& function, XrayOfCall xray) {
  xrays()[function] = std::move(xray);
  return true;
}

LastCall& last_call() {
  thread_local LastCall call;
  return call;
}

namespace {

std::deque<LastCall>& earlier_calls() {
  thread_local std::deque<LastCall> calls;
  return calls;
}

// The numbers that a story names as found; none where it has words instead.
std::vector<double> found_in(const std::string& story) {
  constexpr std::string_view kFound = "\n  found:";
  const std::size_t begin = story.find(kFound);
  if (begin == story.npos) return {};
  const std::string line =
      story.substr(begin + kFound.size(), story.find('\n', begin + 1) - begin - kFound.size());
  std::vector<double> numbers;
  const char* at = line.c_str() + std::min(line.find_first_not_of(" ("), line.size());
  for (char* end = nullptr; *at != '\0'; at = end) {
    const double value = std::strtod(at, &end);
    if (end == at) break;
    numbers.push_back(value);
    end += std::strspn(end, ",; ");
  }
  return numbers;
}

// Whether the numbers, of twelve digits, stand in the answer one behind the other.
bool holds(const VectorXd& answer, const std::vector<double>& numbers) {
  const auto n = static_cast<Eigen::Index>(numbers.size());
  if (n == 0) return false;
  const VectorXd part = Eigen::Map<const VectorXd>(numbers.data(), n);
  if (n == 9 && answer.size() == n) {  // a story shows a matrix by rows, an answer has its columns
    const Matrix3d by_columns = Eigen::Map<const Matrix3d>(numbers.data()).transpose();
    if (is_near(answer, Eigen::Map<const VectorXd>(by_columns.data(), n))) return true;
  }
  for (Eigen::Index i = 0; i + n <= answer.size(); ++i)
    if (is_near(answer.segment(i, n), part)) return true;
  return false;
}

struct Described {
  std::string words;
  VectorXd found = {};
};

Described described_last_call() {
  const LastCall& call = last_call();
  const auto found = xrays().find(call.function);
  if (found == xrays().end()) return {};
  try {
    modules::Reader arguments(call.arguments), answer(call.answer);
    const auto xray = found->second(arguments, answer);
    if (!xray) return {};
    return {xray_in_words(*xray, !call.answer.empty()), xray->found};
  } catch (const modules::WireError&) {
    return {};  // the arguments were too long to keep
  }
}

}  // namespace

void begin_call_to_show() {
  constexpr std::size_t kKept = 16;
  std::deque<LastCall>& earlier = earlier_calls();
  if (!last_call().function.empty()) earlier.push_back(std::move(last_call()));
  if (earlier.size() > kKept) earlier.pop_front();
  last_call() = {};
}

std::string xray_of_last_call(const std::string& story) {
  const LastCall last = last_call();
  const Described of_last = described_last_call();
  const std::vector<double> named = found_in(story);
  std::string words = of_last.words;
  bool is_the_one = !words.empty() && holds(of_last.found, named);
  if (last.answer.empty() || is_the_one || (!words.empty() && named.empty())) return words;
  for (const LastCall& call : earlier_calls()) {
    if (call.function != last.function || call.answer.empty()) continue;
    last_call() = call;  // a description asks it for what was asked
    const Described earlier = described_last_call();
    if (earlier.words.empty()) continue;
    is_the_one = holds(earlier.found, named);
    if (is_the_one || words.empty()) words = earlier.words;
    if (is_the_one || named.empty()) break;
  }
  last_call() = last;
  // what the story names came of many calls, or of another question about them
  if (!words.empty() && !named.empty() && !is_the_one)
    words.insert(words.find(kXrayMark) + kXrayMark.size(), "one call of this test: ");
  return words;
}

}  // namespace tumble::grading
