// System calls by number, as no library would make them: "62 1 9" is kill(1, SIGKILL). A word that
// is no number is a text, passed by its address; "@" is a zeroed block of memory. The answer is the
// error, or "done".
#include <errno.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <sstream>

#include "tests/modules/waist.h"

namespace tumble::waist {

std::string attack(const std::string& what) {
  static char block[4096];
  std::istringstream in(what);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  long numbers[7] = {};
  for (std::size_t i = 0; i < words.size() && i < 7; ++i) {
    char* end = nullptr;
    numbers[i] = std::strtol(words[i].c_str(), &end, 10);
    if (words[i] == "@")
      numbers[i] = reinterpret_cast<long>(block);
    else if (*end != '\0')
      numbers[i] = reinterpret_cast<long>(words[i].c_str());
  }
  const long result =
      ::syscall(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5], numbers[6]);
  return result >= 0 ? "done" : std::strerror(errno);
}

double twice(double x) { return 2.0 * x; }
Everything echo(const Everything& value) { return value; }
double call_back(const std::function<double(double)>&, int) { return 0.0; }
double missing(double) { return 0.0; }
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>&, const VectorXd& y,
              const std::string&) {
  return y;
}

}  // namespace tumble::waist
