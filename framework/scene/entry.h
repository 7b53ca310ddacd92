/// One entry of a scene file, as an effect reads it: values by key, points of bodies, refusals that name the entry's place. The schema has been
/// checked: what it requires is there and of the right kind.
#pragma once

#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct EntrySource;   // the JSON and what it stands in: read_entry.h

class Entry {
 public:
  /// @param pointer  JSON pointer of the entry  @param number  its place in its list, from 1
  Entry(EntrySource& source, std::string pointer, int number) : source_(source), pointer_(std::move(pointer)), number_(number) {}

  const std::string& pointer() const { return pointer_; }
  int number() const { return number_; }
  bool has(const char* key) const;

  /// Leaves the value as it is where the key is absent.
  void read(const char* key, double& value) const;
  void read(const char* key, std::string& value) const;
  void read(const char* key, Vector3d& value) const;

  /// Name of a body that is there. @pre the key is there
  /// @throws UserError at the key where no body has that name
  std::string body(const char* key);
  /// A point of a body or of the world: an entry of the schema's kind "anchor". @throws UserError
  AnchorSpec anchor(const char* key);
  /// Where an anchor is at the start. World frame. [m]
  Vector3d place_at_start(const AnchorSpec& anchor);
  /// The entry itself, where it is three numbers.
  Vector3d vector() const;

  /// Refuses the value under a key; with an empty key the whole entry.
  /// @throws UserError with file, line and pointer
  [[noreturn]] void refuse(const std::string& key, const std::string& problem, const std::string& remedy = "") const;

 private:
  EntrySource& source_;
  std::string pointer_;
  int number_;
};

}  // namespace tumble::scene
