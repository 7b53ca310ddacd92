#include "framework/sampling/kept_chain.h"

#include <cstdlib>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "framework/core/error.h"

namespace tumble::sampling {
namespace {

/// Reads numbers one by one; what cannot be read is an error.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text), at_(text_.c_str()) {}
  double next() {
    char* end = nullptr;
    const double value = std::strtod(at_, &end);
    if (end == at_) throw UserError("a kept chain", "ends in the middle", "Sample it --again.");
    at_ = end;
    return value;
  }
  int whole() { return static_cast<int>(next()); }

 private:
  std::string text_;
  const char* at_;
};

}  // namespace

std::string text_of(const Chain& chain) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{} {} {} {} {} {}\n", chain.number, chain.accepted, chain.simulations,
                 chain.broken, chain.x.rows(), chain.x.cols());
  for (Eigen::Index i = 0; i < chain.x.rows(); ++i) {
    for (Eigen::Index j = 0; j < chain.x.cols(); ++j) fmt::format_to(out, "{} ", chain.x(i, j));
    fmt::format_to(out, "{} {} {}\n", chain.log_target[i], chain.violation[i], chain.cpu_s[i]);
  }
  return text;
}

Chain chain_of(std::string_view text) {
  Numbers numbers(text);
  Chain chain;
  chain.number = numbers.whole();
  chain.accepted = numbers.whole();
  chain.simulations = numbers.whole();
  chain.broken = numbers.whole();
  const int rows = numbers.whole(), columns = numbers.whole();
  if (rows < 0 || columns < 0)
    throw UserError("a kept chain", "has a negative size", "Sample it --again.");
  chain.x = MatrixXd(rows, columns);
  chain.log_target = chain.violation = chain.cpu_s = VectorXd(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) chain.x(i, j) = numbers.next();
    chain.log_target[i] = numbers.next();
    chain.violation[i] = numbers.next();
    chain.cpu_s[i] = numbers.next();
  }
  return chain;
}

std::string csv_of(const std::vector<std::string>& names, const std::vector<Chain>& chains) {
  std::string text = "chain,step";
  for (const std::string& name : names) {
    text += ",\"";
    for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    text += '"';
  }
  text += ",log_target,violation\n";
  const auto out = std::back_inserter(text);
  for (const Chain& chain : chains)
    for (Eigen::Index i = 0; i < chain.x.rows(); ++i) {
      fmt::format_to(out, "{},{}", chain.number + 1, i + 1);
      for (Eigen::Index j = 0; j < chain.x.cols(); ++j) fmt::format_to(out, ",{}", chain.x(i, j));
      fmt::format_to(out, ",{},{}\n", chain.log_target[i], chain.violation[i]);
    }
  return text;
}

}  // namespace tumble::sampling
