#include "framework/scene/read_entry.h"

#include "framework/scene/read_json.h"

namespace tumble::scene {

bool Entry::has(const char* key) const { return source_.value.contains(key); }
void Entry::read(const char* key, double& value) const { scene::read(source_.value, key, value); }
void Entry::read(const char* key, std::string& value) const {
  scene::read(source_.value, key, value);
}
void Entry::read(const char* key, Vector3d& value) const { scene::read(source_.value, key, value); }

std::string Entry::body(const char* key) {
  return source_.anchors.expect_body(source_.value.at(key), pointer_ + '/' + key).name;
}
AnchorSpec Entry::anchor(const char* key) {
  return source_.anchors.read_anchor(source_.value.at(key), pointer_ + '/' + key);
}
Vector3d Entry::place_at_start(const AnchorSpec& anchor) {
  return source_.anchors.place_at_start(anchor);
}
Vector3d Entry::vector() const { return read_vector(source_.value); }

void Entry::refuse(const std::string& key, const std::string& problem,
                   const std::string& remedy) const {
  source_.document.refuse(key.empty() ? pointer_ : pointer_ + '/' + key, problem, remedy);
}

}  // namespace tumble::scene
