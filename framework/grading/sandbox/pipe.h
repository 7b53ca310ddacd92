/// A pipe whose ends the program that is started does not inherit.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <stdexcept>

namespace tumble::grading {

struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no descriptor left for a sandbox");
    read_end = ends[0];
    write_end = ends[1];
  }
};

}  // namespace tumble::grading
