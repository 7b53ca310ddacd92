/// A child process with pipes: lines go in, records or text come out.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace tumble::live {

class Child {
 public:
  /// Starts a program, which dies with this process. @throws std::runtime_error where none starts
  explicit Child(const std::vector<std::string>& words);
  /// Kills it, where it has not ended, and waits.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// A line into its standard input; lost where it reads no more.
  void say(const std::string& line);
  void close_input();

  int output() const { return output_; }  // its standard output, not blocking
  int talk() const { return talk_; }      // its standard error, not blocking
  bool talk_is_open() const { return talk_is_open_; }

  /// Reads what is there on its standard error.
  void read_talk(std::string& text);
  /// Reads what is there. @return false at the end
  static bool read_some(int fd, std::string& text);
  /// Waits for its end. @return its exit code; 128 + the signal that ended it
  int wait();

 private:
  pid_t pid_ = -1;
  int input_ = -1, output_ = -1, talk_ = -1;
  bool has_ended_ = false, talk_is_open_ = true;
  int code_ = 0;
};

}  // namespace tumble::live
