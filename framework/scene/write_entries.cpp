#include "framework/scene/write_entries.h"

#include "framework/core/error.h"
#include "framework/scene/read_entry.h"
#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

template <class Value>
json json_of(const Value& value) {
  return value;
}

}  // namespace

struct EntryWriter::EntryReader {
  explicit EntryReader(Scene& scene)
      : scene(scene), document{{}, {}, scene.file}, anchors(document, scene) {}

  void read(const std::string& key, const json& value) {
    const Words* words = words_of(key);
    if (words == nullptr)
      throw UserError(scene.name, "asks for \"" + key + "\", which this program is not built with",
                      "add its effect to framework/effects/CMakeLists.txt and build again");
    EntrySource source{value, document, anchors};
    Entry entry(source, "", 1);
    words->read(entry, scene);
  }

  Scene& scene;
  Document document;
  Anchors anchors;
};

EntryWriter::EntryWriter(Scene& scene) : reader_(std::make_unique<EntryReader>(scene)) {}
EntryWriter::~EntryWriter() = default;

void EntryWriter::operator()(const std::string& key,
                             const std::vector<std::pair<std::string, Value>>& entry) {
  json object = json::object();
  for (const auto& [name, value] : entry)
    object[name] = std::visit([](const auto& plain) { return json_of(plain); }, value);
  reader_->read(key, object);
}

void EntryWriter::operator()(const std::string& key, const Vector3d& value) {
  reader_->read(key, json_of(value));
}

void remove_entries(Scene& scene, const std::string& key) {
  if (const Words* words = words_of(key)) words->clear(scene);
}

bool has_entries(const Scene& scene, const std::string& key) {
  const Words* words = words_of(key);
  return words != nullptr && words->is_asked(scene);
}

}  // namespace tumble::scene
