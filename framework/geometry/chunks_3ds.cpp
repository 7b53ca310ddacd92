#include "framework/geometry/chunks_3ds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "framework/core/error.h"

namespace tumble {
namespace {

// assimp needs about 12 bytes of memory for each byte of the file
constexpr std::size_t kMostBytes = 32u << 20;
constexpr int kMostFaces = 500'000;         // and about 300 for each face
constexpr std::size_t kMostMeshes = 5'000;  // and 1 kB for each mesh, however small
constexpr int kDeepest = 16;                // real files nest 5 deep
constexpr std::size_t kHeader = 6;          // id and length

enum Chunk : std::uint16_t {
  kMain = 0x4D4D,
  kEditor = 0x3D3D,
  kMasterScale = 0x0100,
  kObject = 0x4000,
  kTriangles = 0x4100,
  kVertices = 0x4110,
  kFaces = 0x4120,
  kFaceMaterial = 0x4130,
  kSmoothing = 0x4150,
  kMatrix = 0x4160,
  kKeyframer = 0xB000,
  kObjectNode = 0xB002,
  kFirstNode = 0xB001,
  kLastNode = 0xB007,
  kPositionTrack = 0xB020,
  kRotationTrack = 0xB021,
  kScaleTrack = 0xB022,
  kLastTrack = 0xB029,
  kHidden = 0x7FFF,  // not a chunk of the format: readers skip it
};

const char* name_of(std::uint16_t id) {
  switch (id) {
    case kMain: return "main";
    case kEditor: return "editor";
    case kObject: return "object";
    case kTriangles: return "triangle mesh";
    case kVertices: return "vertex list";
    case kFaces: return "face list";
    case kMatrix: return "mesh matrix";
    case kKeyframer: return "keyframer";
    case kObjectNode: return "object node";
    default: return "unnamed";
  }
}

// The format that a file which is not 3DS most likely has.
std::string guess(std::string_view bytes) {
  const auto starts = [&](std::string_view magic) {
    return bytes.substr(0, magic.size()) == magic;
  };
  if (starts("\x89PNG")) return " (it looks like a PNG picture)";
  if (starts("\xFF\xD8\xFF")) return " (it looks like a JPEG picture)";
  if (starts("PK\x03\x04")) return " (it looks like a zip archive: unpack it)";
  if (starts("glTF")) return " (it looks like a glTF model)";
  if (starts("solid")) return " (it looks like an STL model)";
  if (starts("ply")) return " (it looks like a PLY model)";
  const auto text = [](char c) {
    return c == '\n' || c == '\r' || c == '\t' || (c >= ' ' && c <= '~');
  };
  const std::string_view start = bytes.substr(0, 64);
  return std::all_of(start.begin(), start.end(), text) ? " (it looks like a text file)" : "";
}

class Checker {
 public:
  Checker(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(where) {
    found_.bytes = bytes;
  }

  Checked3ds run() {
    check_start();
    walk(kHeader, main_end_, 1);
    return std::move(found_);
  }

 private:
  [[noreturn]] void refuse(std::size_t offset, const std::string& problem,
                           const std::string& remedy) const {
    throw UserError(where_, fmt::format("at byte {}: {}", offset, problem), remedy);
  }
  [[noreturn]] void refuse_damaged(std::size_t offset, const std::string& problem) const {
    refuse(offset, problem, "The file is damaged: export it again from the modelling program.");
  }

  template <class T>
  T read(std::size_t offset) const {
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  std::string mesh_name() const {
    return found_.meshes.empty() ? std::string("?") : found_.meshes.back().name;
  }

  void check_start() {
    const std::string remedy = "Export the model as 3D Studio (.3ds).";
    if (bytes_.empty()) throw UserError(where_, "the file is empty", remedy);
    if (bytes_.size() > kMostBytes) {
      throw UserError(where_,
                      fmt::format("the file has {:.1f} MiB, and the limit is {}",
                                  bytes_.size() / 1048576.0, kMostBytes >> 20),
                      "Simplify the model.");
    }
    if (bytes_.size() < 2 || read<std::uint16_t>(0) != kMain) {
      std::string start;
      for (unsigned char c : bytes_.substr(0, 4))
        start += fmt::format("{}{:02X}", start.empty() ? "" : " ", c);
      throw UserError(where_,
                      fmt::format("not a 3DS file: it starts with bytes {}, expected 4D 4D{}",
                                  start, guess(bytes_)),
                      remedy);
    }
    if (bytes_.size() < kHeader) throw truncated(bytes_.size());
    const std::uint32_t length = read<std::uint32_t>(2);
    if (length > bytes_.size()) throw truncated(length);
    if (length < kHeader)
      refuse_damaged(
          0, fmt::format("the main chunk declares a length of {} bytes, less than its own header",
                         length));
    main_end_ = length;
  }

  UserError truncated(std::size_t wanted) const {
    return UserError(where_,
                     fmt::format("truncated: it declares {} bytes, but has {}",
                                 std::max(wanted, kHeader), bytes_.size()),
                     "Copy or export it again.");
  }

  void walk(std::size_t at, std::size_t end, int depth) {
    if (depth > kDeepest)
      refuse_damaged(at, fmt::format("chunks are nested more than {} deep", kDeepest));
    while (end - at >= kHeader) {
      const std::uint16_t id = read<std::uint16_t>(at);
      const std::uint32_t length = read<std::uint32_t>(at + 2);
      if (length < kHeader || length > end - at) {
        refuse_damaged(
            at, fmt::format("chunk {:04X} ({}) declares {} bytes, but its parent has {} left", id,
                            name_of(id), length, end - at));
      }
      enter(id, at, at + kHeader, at + length, depth);
      at += length;
    }
  }

  void hide(std::size_t at) { std::memcpy(found_.bytes.data() + at, "\xFF\x7F", 2); }

  void enter(std::uint16_t id, std::size_t at, std::size_t data, std::size_t end, int depth) {
    switch (id) {
      case kMasterScale:
      case kFaceMaterial:
      case kSmoothing: return hide(at);
      case kEditor: return walk(data, end, depth + 1);
      case kKeyframer: return walk(data, end, depth + 1);
      case kObjectNode: found_.has_nodes = true; return walk(data, end, depth + 1);
      case kObject: return walk(read_name(data, end), end, depth + 1);
      case kTriangles: return check_mesh(at, data, end, depth);
      case kVertices: return check_vertices(at, data, end);
      case kFaces: return check_faces(at, data, end, depth);
      case kMatrix: return check_matrix(at, data, end);
      default: break;
    }
    if (id >= kFirstNode && id <= kLastNode) return walk(data, end, depth + 1);
    if (id >= kPositionTrack && id <= kLastTrack) check_track(id, at, data, end);
  }

  // A track: 10 bytes of flags, a count u32, then keys, each a frame u32, flags u16 and a value.
  // assimp allocates memory by the count.
  void check_track(std::uint16_t id, std::size_t at, std::size_t data, std::size_t end) const {
    constexpr std::size_t kTrackHeader = 14, kKeyHeader = 6;
    if (end - data < kTrackHeader)
      refuse_damaged(
          at, fmt::format("animation track {:04X} needs {} bytes, but its chunk holds {}", id,
                          kTrackHeader, end - data));
    const std::size_t value = id == kRotationTrack                        ? 16
                              : id == kPositionTrack || id == kScaleTrack ? 12
                                                                          : 0;
    const std::uint32_t count = read<std::uint32_t>(data + 10);
    const std::size_t room = (end - data - kTrackHeader) / (kKeyHeader + value);
    if (count > room)
      refuse_damaged(
          at, fmt::format("animation track {:04X} declares {} keys, but its chunk holds at most {}",
                          id, count, room));
  }

  std::size_t read_name(std::size_t data, std::size_t end) {
    const auto* start = bytes_.data() + data;
    const auto* stop = static_cast<const char*>(std::memchr(start, 0, end - data));
    if (stop == nullptr) refuse_damaged(data, "an object's name has no end");
    object_name_.assign(start, stop);
    for (char& c : object_name_) {
      if (c < ' ' || c > '~') c = '?';  // names go into messages and pages
    }
    return data + (stop - start) + 1;
  }

  void check_mesh(std::size_t at, std::size_t data, std::size_t end, int depth) {
    if (found_.meshes.size() >= kMostMeshes)
      refuse(at, fmt::format("more than {} meshes", kMostMeshes), "Split the file.");
    found_.meshes.push_back({object_name_, 0, 0});
    highest_index_.reset();
    walk(data, end, depth + 1);
    const DeclaredMesh& mesh = found_.meshes.back();
    if (highest_index_ && *highest_index_ >= mesh.vertices) {
      refuse_damaged(highest_index_at_,
                     fmt::format("mesh '{}': a face refers to vertex {}, but there are {} vertices",
                                 mesh.name, *highest_index_, mesh.vertices));
    }
  }

  int read_count(std::size_t at, std::size_t data, std::size_t end, std::size_t size,
                 const char* what) const {
    const int count = end - data >= 2 ? read<std::uint16_t>(data) : -1;
    const std::size_t room = count < 0 ? 0 : (end - data - 2) / size;
    if (count < 0 || static_cast<std::size_t>(count) > room) {
      refuse_damaged(at, fmt::format("mesh '{}' declares {} {}, but its chunk holds at most {}",
                                     mesh_name(), std::max(count, 0), what, room));
    }
    return count;
  }

  void check_vertices(std::size_t at, std::size_t data, std::size_t end) {
    if (found_.meshes.empty()) refuse_damaged(at, "a vertex list outside any mesh");
    const int count = read_count(at, data, end, 12, "vertices");
    found_.meshes.back().vertices = count;
    for (int i = 0; i < 3 * count; ++i) {
      const std::size_t place = data + 2 + 4 * static_cast<std::size_t>(i);
      const float value = read<float>(place);
      if (!std::isfinite(value)) {
        refuse_damaged(place, fmt::format("mesh '{}': coordinate {} of vertex {} is {}",
                                          mesh_name(), "xyz"[i % 3], i / 3,
                                          std::isnan(value) ? "NaN (not a number)" : "infinite"));
      }
    }
  }

  void check_faces(std::size_t at, std::size_t data, std::size_t end, int depth) {
    if (found_.meshes.empty()) refuse_damaged(at, "a face list outside any mesh");
    const int count = read_count(at, data, end, 8, "faces");
    found_.meshes.back().faces = count;
    total_faces_ += count;
    if (total_faces_ > kMostFaces)
      refuse(at, fmt::format("more than {} faces", kMostFaces), "Simplify the model.");
    for (int i = 0; i < count; ++i) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::size_t place = data + 2 + 8 * static_cast<std::size_t>(i) + 2 * corner;
        const int index = read<std::uint16_t>(place);
        if (highest_index_ && index <= *highest_index_) continue;
        highest_index_ = index;
        highest_index_at_ = place;
      }
    }
    // materials and smoothing groups follow the list
    walk(data + 2 + 8 * static_cast<std::size_t>(count), end, depth + 1);
  }

  void check_matrix(std::size_t at, std::size_t data, std::size_t end) const {
    double m[12];
    if (end - data < 48)
      refuse_damaged(at, fmt::format("mesh '{}': its matrix needs 48 bytes, but its chunk holds {}",
                                     mesh_name(), end - data));
    for (int i = 0; i < 12; ++i) {
      m[i] = read<float>(data + 4 * static_cast<std::size_t>(i));
      if (!std::isfinite(m[i]))
        refuse_damaged(data + 4 * static_cast<std::size_t>(i),
                       fmt::format("mesh '{}': its matrix is not finite", mesh_name()));
    }
    const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
                               m[1] * (m[3] * m[8] - m[5] * m[6]) +
                               m[2] * (m[3] * m[7] - m[4] * m[6]);
    if (determinant == 0.0)
      refuse_damaged(
          at, fmt::format("mesh '{}': its matrix is singular (it flattens space)", mesh_name()));
  }

  std::string_view bytes_;
  const std::string& where_;
  Checked3ds found_;
  std::size_t main_end_ = 0;
  std::string object_name_;
  std::optional<int> highest_index_;
  std::size_t highest_index_at_ = 0;
  int total_faces_ = 0;
};

}  // namespace

Checked3ds check_3ds(std::string_view bytes, const std::string& where) {
  return Checker(bytes, where).run();
}

}  // namespace tumble
