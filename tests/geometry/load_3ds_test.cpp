// Files assembled chunk by chunk: several objects, nodes and pivots, welding, scale; and each
// reason to refuse a file.
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/solid.h"
#include "models/surfaces.h"
#include "models/write_3ds.h"
#include "tests/geometry/file_3ds.h"

namespace tumble::testing::load_3ds_test {
namespace {

// coordinates of size 1 to 10 in float32, through one or two transforms in float32
constexpr double kFloat = 1e-6;

TriangleMesh unit_box() { return models::box({0, 0, 0}, {1, 1, 1}); }
std::string lists(const TriangleMesh& mesh) {
  return models::vertex_list(mesh.vertices) + models::face_list(mesh.faces);
}
std::string box_file() { return models::write_3ds({{"box", unit_box()}}); }

Bounds box_of(const LoadedObject& object) { return bounds_of(object.report.mesh); }

void expect_box(const LoadedObject& object, const Vector3d& low, const Vector3d& high) {
  const Bounds found = box_of(object);
  EXPECT_LE((found.low - low).norm(), kFloat * 10)
      << "low corner " << found.low.transpose() << ", expected " << low.transpose();
  EXPECT_LE((found.high - high).norm(), kFloat * 10)
      << "high corner " << found.high.transpose() << ", expected " << high.transpose();
}

/// Refused with all these words.
void expect_refused(const std::string& bytes, std::initializer_list<const char*> words) {
  try {
    parse_3ds(bytes, "model.3ds");
    ADD_FAILURE() << "accepted, but should say: " << *words.begin();
  } catch (const UserError& error) {
    const std::string said = error.what();
    EXPECT_EQ(error.where(), "model.3ds");
    EXPECT_FALSE(error.remedy().empty()) << said;
    for (const char* word : words)
      EXPECT_NE(said.find(word), std::string::npos)
          << "says: " << said << "\nexpected the words: " << word;
  }
}

TEST(Load3ds, ObjectsComeInTheFilesOrderWithTheirNames) {
  const LoadedFile file = parse_3ds(
      models::write_3ds(
          {{"b", unit_box()}, {"a", models::moved(unit_box(), {3, 0, 0})}, {"a", unit_box()}}),
      "f");
  ASSERT_EQ(file.objects.size(), 3u);
  EXPECT_EQ(file.objects[0].name, "b");
  EXPECT_EQ(file.objects[1].name, "a");
  EXPECT_EQ(file.objects[2].name, "a#2");
  expect_box(file.objects[1], {3, 0, 0}, {4, 1, 1});
}

TEST(Load3ds, ZStaysUp) {
  const LoadedFile file =
      parse_3ds(models::write_3ds({{"tall", models::box({0, 0, 0}, {1, 2, 3})}}), "f");
  expect_box(file.objects[0], {0, 0, 0}, {1, 2, 3});
}

TEST(Load3ds, UnitIsChosenByTheCaller) {
  const LoadedFile file = parse_3ds(box_file(), "f", {0.0254});
  expect_box(file.objects[0], {0, 0, 0}, Vector3d::Constant(0.0254));
  EXPECT_THROW(parse_3ds(box_file(), "f", {0.0}), UserError);
  EXPECT_THROW(parse_3ds(box_file(), "f", {-1.0}), UserError);
  EXPECT_THROW(parse_3ds(box_file(), "f", {std::nan("")}), UserError);
}

TEST(Load3ds, MasterScaleOfTheFileIsLeftToTheCaller) {
  const std::string bytes =
      models::file_3ds(chunk(0x0100, f32(1000)) + models::object_chunk("box", lists(unit_box())));
  expect_box(parse_3ds(bytes, "f").objects[0], {0, 0, 0}, {1, 1, 1});
}

TEST(Load3ds, CornersSplitForSmoothingAreWeldedWhereExactlyEqual) {
  // Every face has three vertices of its own, as written by programs with a normal per corner; -0
  // and 0 are the same coordinate.
  TriangleMesh split;
  for (const Face& face : unit_box().faces) {
    for (int v : face) split.vertices.push_back(unit_box().vertices[v]);
    const int n = static_cast<int>(split.vertices.size());
    split.faces.push_back({n - 3, n - 2, n - 1});
  }
  std::string bytes = models::write_3ds({{"box", split}});
  // after id, length and count; it is (0, 0, 0)
  const std::size_t first_vertex = bytes.find(u16(0x4110)) + 8;
  bytes.replace(first_vertex, 4, u32(0x80000000u));
  const ClosedReport report = parse_3ds(bytes, "f").objects[0].report;
  EXPECT_TRUE(report.is_closed());
  EXPECT_EQ(report.mesh.vertices.size(), 8u);
}

TEST(Load3ds, CornersThatDifferInTheLastBitStayApart) {
  TriangleMesh mesh = unit_box();
  // 1 + the spacing of float32 at 1
  mesh.vertices.push_back(mesh.vertices[7] + Vector3d(std::ldexp(1.0, -23), 0, 0));
  for (int& v : mesh.faces[2]) v = v == 7 ? 8 : v;
  EXPECT_FALSE(parse_3ds(models::write_3ds({{"box", mesh}}), "f").objects[0].report.is_closed());
}

TEST(Load3ds, SmoothingGroupsAndMaterialsDoNotSplitAnObject) {
  std::string faces = models::face_list(unit_box().faces);
  std::string groups, material = std::string("red") + '\0' + u16(6);
  for (int f = 0; f < 12; ++f) groups += u32(1u << (f / 2));
  for (int f = 0; f < 6; ++f) material += u16(static_cast<std::uint16_t>(f));
  faces = chunk(0x4120, faces.substr(6) + chunk(0x4130, material) + chunk(0x4150, groups));
  const LoadedFile file = parse_3ds(models::file_3ds(models::object_chunk(
                                        "box", models::vertex_list(unit_box().vertices) + faces)),
                                    "f");
  ASSERT_EQ(file.objects.size(), 1u);
  EXPECT_TRUE(file.objects[0].report.is_closed());
  EXPECT_EQ(file.objects[0].report.mesh.vertices.size(), 8u);
}

// A file stores an object's vertices in world coordinates as modelled; the matrix is the object's
// frame at that time, the node its frame at animation frame 0: world = position * rotation *
// (matrix^-1 * vertex - pivot).
TEST(Load3ds, NodeMovesTheObjectFromItsModelledToItsKeyedPlace) {
  const Eigen::Affine3d modelled(Eigen::Translation3d(5, 0, 0));
  const std::string object = models::object_chunk(
      "box", lists(models::moved(unit_box(), {5, 0, 0})) + matrix_chunk(modelled));
  Node node{"box"};
  node.position = {0, 0, 7};
  const LoadedFile file = parse_3ds(models::file_3ds(object, keyframer(node_chunk(node))), "f");
  ASSERT_EQ(file.objects.size(), 1u);
  EXPECT_EQ(file.objects[0].name, "box");
  expect_box(file.objects[0], {0, 0, 7}, {1, 1, 8});
}

TEST(Load3ds, PivotIsSubtractedBeforeTheNodePlacesTheObject) {
  Node node{"box"};
  node.pivot = {1, 0, 0};
  node.position = {10, 0, 0};
  const std::string object =
      models::object_chunk("box", lists(unit_box()) + matrix_chunk(Eigen::Affine3d::Identity()));
  expect_box(parse_3ds(models::file_3ds(object, keyframer(node_chunk(node))), "f").objects[0],
             {9, 0, 0}, {10, 1, 1});
}

TEST(Load3ds, NodeRotatesAboutThePivotAndTheSolidKeepsItsVolume) {
  Node node{"box"};
  node.pivot = {1, 0, 0};
  node.angle = 3.14159265358979 / 2;
  const std::string object =
      models::object_chunk("box", lists(unit_box()) + matrix_chunk(Eigen::Affine3d::Identity()));
  const LoadedObject loaded =
      parse_3ds(models::file_3ds(object, keyframer(node_chunk(node))), "f").objects[0];
  ASSERT_TRUE(loaded.report.is_closed());
  EXPECT_NEAR(signed_volume(loaded.report.mesh), 1.0, 10 * kFloat);
  // [-1, 0] x [0, 1] about the pivot, rotated by 90 degrees about z: [0, 1] or [-1, 0] along x,
  // depending on the sense of rotation.
  const Bounds found = box_of(loaded);
  EXPECT_NEAR((found.high - found.low).x(), 1.0, kFloat);
  EXPECT_NEAR(std::abs(0.5 * (found.high + found.low).x()), 0.5, kFloat);
}

TEST(Load3ds, MirroringMatrixStillGivesAnOutwardSolid) {
  Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
  mirror.linear()(0, 0) = -1;
  const std::string object = models::object_chunk("box", lists(unit_box()) + matrix_chunk(mirror));
  const ClosedReport report = parse_3ds(models::file_3ds(object), "f").objects[0].report;
  ASSERT_TRUE(report.is_closed());
  EXPECT_NEAR(signed_volume(report.mesh), 1.0, kFloat);
}

TEST(Load3ds, InvertedObjectIsFlippedWithANotice) {
  TriangleMesh mesh = unit_box();
  for (Face& face : mesh.faces) std::swap(face[0], face[1]);
  const ClosedReport report = parse_3ds(models::write_3ds({{"box", mesh}}), "f").objects[0].report;
  ASSERT_TRUE(report.is_closed());
  EXPECT_DOUBLE_EQ(signed_volume(report.mesh), 1.0);
  EXPECT_EQ(report.notices.size(), 1u);
}

TEST(Refused3ds, EmptyFile) { expect_refused("", {"the file is empty"}); }
TEST(Refused3ds, Picture) {
  expect_refused("\x89PNG\r\n\x1a\n and so on", {"not a 3DS file", "89 50 4E 47", "PNG picture"});
}
TEST(Refused3ds, TextFile) {
  expect_refused("v 0 0 0\nv 1 0 0\nf 1 2 3\n", {"not a 3DS file", "text file"});
}
TEST(Refused3ds, FileOfOneByte) { expect_refused("M", {"not a 3DS file"}); }
TEST(Refused3ds, NoSuchFile) { EXPECT_THROW(load_3ds("/no/such/file.3ds"), UserError); }
TEST(Refused3ds, Folder) { EXPECT_THROW(load_3ds("/"), UserError); }

TEST(Refused3ds, TruncatedAnywhere) {
  const std::string whole = box_file();
  for (std::size_t length = 6; length < whole.size(); ++length) {
    expect_refused(whole.substr(0, length),
                   {"truncated: it declares 256 bytes, but has", std::to_string(length).c_str()});
  }
}

TEST(Refused3ds, CountOfVerticesThatTheFileCannotHold) {
  std::string bytes = box_file();
  const std::size_t list = bytes.find(u16(0x4110) + u32(6 + 2 + 8 * 12));
  bytes.replace(list + 6, 2, u16(60000));
  expect_refused(bytes,
                 {"mesh 'box' declares 60000 vertices, but its chunk holds at most 8", "at byte"});
}

TEST(Refused3ds, CountOfFacesThatTheFileCannotHold) {
  std::string bytes = box_file();
  const std::size_t list = bytes.find(u16(0x4120) + u32(6 + 2 + 12 * 8));
  bytes.replace(list + 6, 2, u16(13));
  expect_refused(bytes, {"mesh 'box' declares 13 faces, but its chunk holds at most 12"});
}

TEST(Refused3ds, ChunkLongerThanItsParent) {
  std::string bytes = box_file();
  const std::size_t list = bytes.find(u16(0x4120) + u32(6 + 2 + 12 * 8));
  bytes.replace(list + 2, 4, u32(0x7FFFFFFF));
  expect_refused(bytes,
                 {"chunk 4120 (face list) declares 2147483647 bytes, but its parent has 104 left"});
}

TEST(Refused3ds, FaceThatRefersToAMissingVertex) {
  TriangleMesh mesh = unit_box();
  mesh.faces[3][2] = 8;
  expect_refused(models::write_3ds({{"box", mesh}}),
                 {"mesh 'box': a face refers to vertex 8, but there are 8 vertices"});
}

TEST(Refused3ds, NotANumber) {
  TriangleMesh mesh = unit_box();
  mesh.vertices[3].y() = std::nan("");
  expect_refused(models::write_3ds({{"box", mesh}}),
                 {"mesh 'box': coordinate y of vertex 3 is NaN"});
}

TEST(Refused3ds, Infinity) {
  TriangleMesh mesh = unit_box();
  mesh.vertices[0].z() = std::numeric_limits<double>::infinity();
  expect_refused(models::write_3ds({{"box", mesh}}),
                 {"mesh 'box': coordinate z of vertex 0 is infinite"});
}

TEST(Refused3ds, SingularMatrix) {
  Eigen::Affine3d flat = Eigen::Affine3d::Identity();
  flat.linear()(2, 2) = 0;
  expect_refused(
      models::file_3ds(models::object_chunk("box", lists(unit_box()) + matrix_chunk(flat))),
      {"mesh 'box': its matrix is singular"});
}

TEST(Refused3ds, CountOfKeysThatATrackCannotHold) {
  const std::string track_of_many = chunk(
      0xB020, u16(0) + u32(0) + u32(0) + u32(0x40000000) + u32(0) + u16(0) + numbers({1, 2, 3}));
  const std::string bytes = models::file_3ds(models::object_chunk("box", lists(unit_box())),
                                             keyframer(chunk(0xB002, track_of_many)));
  expect_refused(bytes,
                 {"animation track B020 declares 1073741824 keys, but its chunk holds at most 1"});
}

TEST(Refused3ds, FileWithoutAnyMesh) { expect_refused(models::file_3ds(""), {"holds no mesh"}); }

TEST(Refused3ds, ChunksNestedWithoutEnd) {
  std::string nest;
  for (int i = 0; i < 40; ++i) nest = chunk(0x3D3D, nest);
  expect_refused(chunk(0x4D4D, nest), {"nested more than 16 deep"});
}

TEST(Refused3ds, NameWithoutEnd) {
  expect_refused(models::file_3ds(chunk(0x4000, "boxboxbox")), {"an object's name has no end"});
}

}  // namespace
}  // namespace tumble::testing::load_3ds_test
