/// What a grading of hostile submissions left behind, or whom it reached: processes, files with the
/// mark's name, objects of System V, connections to services of this machine, the grader's own
/// temporary folders.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace tumble::grading {

/// Watches from its construction on. This process adopts orphans from then on, so that it sees
/// those of the gradings that it starts.
class Watchers {
 public:
  /// @param mark  no file may have it in its name afterwards
  explicit Watchers(std::string mark);
  Watchers(const Watchers&) = delete;
  Watchers& operator=(const Watchers&) = delete;
  ~Watchers();

  /// Of a service on this machine.
  int port() const { return port_; }
  /// Name of the same service's abstract socket.
  const std::string& socket_name() const { return mark_; }

  /// Call after a grading has ended.
  /// @param folders  searched for the mark, beside the usual places where anybody may write
  /// @return a sentence for each thing found; processes are ended and files stay
  std::vector<std::string> found(const std::vector<std::filesystem::path>& folders);

 private:
  void end_processes(std::vector<std::string>& faults) const;
  void look_for_connections(std::vector<std::string>& faults) const;

  std::string mark_;
  int tcp_ = -1, local_ = -1, port_ = 0;
  std::set<std::string> objects_, stages_;  // before
};

}  // namespace tumble::grading
