/// Whether a scene that was saved runs again byte for byte, by the same code.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/live/scenes.h"
#include "framework/live/simulator.h"

namespace tumble::live {

class SaveCheck {
 public:
  explicit SaveCheck(Pages& pages) : pages_(pages) {}

  /// Begins, in place of a check that is not over.
  /// @param expected  the frames of the run that was saved, which may be begun anew meanwhile
  void begin(const std::vector<std::string>& simulator, const SavedScene& saved,
             const std::vector<std::string>& expected);
  const Child* child() const { return simulator_ ? &simulator_->child : nullptr; }
  void listen();
  /// What was told last, for a page that opens: JSON; empty: nothing.
  const std::string& told() const { return told_; }

 private:
  Pages& pages_;
  std::unique_ptr<Simulator> simulator_;
  std::vector<std::string> expected_;
  std::size_t frames_checked_ = 0;
  std::string first_wrong_, told_;
};

}  // namespace tumble::live
