/// One entry of a scene file, as an effect reads it: values by key, points of bodies, refusals with
/// the entry's position. The schema has been checked: required values exist and are of the right
/// kind.
#pragma once

#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct EntrySource;  // the JSON and its context: read_entry.h

class Entry {
 public:
  /// @param pointer  JSON pointer of the entry  @param number  its number in its list, from 1
  Entry(EntrySource& source, std::string pointer, int number)
      : source_(source), pointer_(std::move(pointer)), number_(number) {}

  const std::string& pointer() const { return pointer_; }
  int number() const { return number_; }
  bool has(const char* key) const;

  /// Leaves the value unchanged where the key is absent.
  void read(const char* key, double& value) const;
  void read(const char* key, std::string& value) const;
  void read(const char* key, Vector3d& value) const;

  /// Name of an existing body. @pre the key exists
  /// @throws UserError at the key where no body has that name
  std::string body(const char* key);
  /// A point of a body or of the world: an entry of the schema's kind "anchor". @throws UserError
  AnchorSpec anchor(const char* key);
  /// Position of an anchor at the start. World frame. [m]
  Vector3d place_at_start(const AnchorSpec& anchor);
  /// The entry itself, for an entry of three numbers.
  Vector3d vector() const;

  /// Refuses the value under a key; with an empty key the whole entry.
  /// @throws UserError with file, line and pointer
  [[noreturn]] void refuse(const std::string& key, const std::string& problem,
                           const std::string& remedy = "") const;

 private:
  EntrySource& source_;
  std::string pointer_;
  int number_;
};

}  // namespace tumble::scene
