/// Adds entries of effects to a scene that is made in memory, in the words of a scene file: whoever makes such a scene needs to know no effect.
///   EntryWriter write(scene);
///   write("rods", {{"name", "rod 1"}, {"a", AnchorSpec{}}, {"b", AnchorSpec{"bob"}}, {"length_m", 1.0}});
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

  /// Adds an entry. Bodies that it names are there. @throws UserError where the program is built without such entries, or this one cannot be
  void operator()(const std::string& key, const std::vector<std::pair<std::string, Value>>& entry);
  /// The same of what is three numbers, such as "gravity_m_s2".
  void operator()(const std::string& key, const Vector3d& value);

 private:
  struct EntryReader;
  std::unique_ptr<EntryReader> reader_;
};

/// Takes all entries of a key out of a scene.
void remove_entries(Scene& scene, const std::string& key);

/// Whether a scene has entries of a key.
bool has_entries(const Scene& scene, const std::string& key);

}  // namespace tumble::scene
