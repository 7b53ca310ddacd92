// check_points ROOT aN_name...: a step of the build before a judge is linked.
#include <cstdio>
#include <exception>

#include "framework/extend/check_points.h"

int main(int count, char** words) {
  if (count < 3) {
    std::fprintf(stderr, "Usage: check_points ROOT aN_name...\n");
    return 2;
  }
  try {
    int faults = 0;
    for (int i = 2; i < count; ++i)
      for (const std::string& fault : tumble::extend::check_points(words[1], words[i])) {
        std::fprintf(stderr, "%s\n", fault.c_str());
        ++faults;
      }
    return faults == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_points: %s\n", error.what());
    return 2;
  }
}
