/// Adds entries of effects to a scene made in memory, with the keys of a scene file, so that the
/// code that makes a scene names no effect's types.
///   EntryWriter write(scene);
///   write("rods", {{"name", "rod 1"}, {"a", AnchorSpec{}}, {"b", AnchorSpec{"bob"}}, {"length_m",
///   1.0}});
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "framework/scene/scene.h"

namespace tumble::scene {

class EntryWriter {
 public:
  using Value = std::variant<double, std::string, Vector3d, AnchorSpec>;

  /// @param scene  must outlive it
  explicit EntryWriter(Scene& scene);
  ~EntryWriter();

  /// Adds an entry. The bodies that it names must exist. @throws UserError where the program has no
  /// such effect, or the entry is impossible
  void operator()(const std::string& key, const std::vector<std::pair<std::string, Value>>& entry);
  /// The same for a value of three numbers, such as "gravity_m_s2".
  void operator()(const std::string& key, const Vector3d& value);

 private:
  struct EntryReader;
  std::unique_ptr<EntryReader> reader_;
};

/// Removes all entries of a key from a scene.
void remove_entries(Scene& scene, const std::string& key);

/// Whether a scene has entries of a key.
bool has_entries(const Scene& scene, const std::string& key);

}  // namespace tumble::scene
