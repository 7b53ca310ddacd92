// The files of models/ equal the generator's output byte for byte; those in models/broken are
// refused, all others are solids.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/solid.h"
#include "models/catalogue.h"

namespace tumble::testing {
namespace {

const std::filesystem::path kModels = std::filesystem::path(test::source_dir()) / "models";

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return std::move(bytes).str();
}

std::vector<models::Model> all_models() {
  std::vector<models::Model> all = models::catalogue();
  for (models::Model& broken : models::broken_catalogue()) all.push_back(std::move(broken));
  return all;
}

TEST(Models, FilesEqualTheGeneratorsOutput) {
  for (const models::Model& model : all_models()) {
    EXPECT_TRUE(bytes_of(kModels / model.file) == models::write_3ds(model.objects))
        << "models/" << model.file << " differs from what build/bin/make_models writes";
  }
}

TEST(Models, EveryFileIsGenerated) {
  std::set<std::string> made;
  for (const models::Model& model : all_models()) made.insert(model.file);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kModels)) {
    if (entry.path().extension() != ".3ds") continue;
    EXPECT_TRUE(made.contains(entry.path().lexically_relative(kModels).string()))
        << entry.path() << " is not generated: add it to catalogue.cpp";
  }
}

TEST(Models, EveryFileIsInTheReadme) {
  const std::string readme = bytes_of(kModels / "README.md");
  for (const models::Model& model : all_models()) {
    EXPECT_NE(readme.find("`" + model.file + "`"), std::string::npos)
        << model.file << " is not in models/README.md";
  }
}

TEST(Models, AllAreSolidsAndReadBackAsGenerated) {
  const auto catalogue = models::catalogue();
  EXPECT_GE(catalogue.size(), 12u);
  for (const models::Model& model : catalogue) {
    const LoadedFile file = load_3ds(kModels / model.file);
    ASSERT_EQ(file.objects.size(), model.objects.size()) << model.file;
    for (std::size_t i = 0; i < file.objects.size(); ++i) {
      const ClosedReport& report = file.objects[i].report;
      EXPECT_EQ(file.objects[i].name, model.objects[i].name);
      ASSERT_TRUE(report.is_closed()) << model.file << ": " << report.defects.front().problem;
      EXPECT_TRUE(report.notices.empty()) << model.file << ": " << report.notices.front();
      EXPECT_EQ(report.mesh.vertices.size(), model.objects[i].mesh.vertices.size()) << model.file;
      EXPECT_EQ(report.mesh.faces.size(), model.objects[i].mesh.faces.size()) << model.file;
      // float32 coordinates: relative error 6e-8 each, three of them in a volume
      const double volume = signed_volume(model.objects[i].mesh);
      EXPECT_NEAR(signed_volume(report.mesh), volume, 1e-6 * volume) << model.file;
    }
  }
}

TEST(Models, HaveTheVolumesOfTheirShapes) {
  const auto volume = [](const char* file) { return load_solid(kModels / file).volume; };
  constexpr double kFloat = 1e-6;  // coordinates are float32
  EXPECT_DOUBLE_EQ(volume("box.3ds"), 1.0);
  EXPECT_DOUBLE_EQ(volume("l_shape.3ds"), 3.0);
  EXPECT_NEAR(volume("wedge.3ds"), 0.5 * 1.0 * 0.5 * 0.8, kFloat);
  EXPECT_NEAR(volume("t_handle.3ds"), 0.15 * (1.0 * 0.15 + 0.15 * 0.45), kFloat);
  // A prism on a regular polygon of 32 sides: area n/2 r^2 sin(2 pi / n).
  EXPECT_NEAR(volume("rod.3ds"), 16 * 0.05 * 0.05 * std::sin(2 * 3.14159265358979 / 32), kFloat);
}

TEST(Models, HandleHasThreeDistinctPrincipalMoments) {
  const MassProperties mass =
      compute_mass_properties(load_3ds(kModels / "t_handle.3ds").objects.front().report.mesh);
  EXPECT_GT(mass.principal_moments[1], 1.3 * mass.principal_moments[0]);
  EXPECT_GT(mass.principal_moments[2], 1.3 * mass.principal_moments[1]);
}

TEST(Models, BrokenOnesAreRefusedExceptTheInvertedOne) {
  for (const models::Model& model : models::broken_catalogue()) {
    const ClosedReport report = load_3ds(kModels / model.file).objects.front().report;
    if (model.file == "broken/inside_out.3ds") {
      EXPECT_TRUE(report.is_closed());
      EXPECT_EQ(report.notices.size(), 1u);
    } else {
      EXPECT_FALSE(report.is_closed()) << model.file;
      EXPECT_THROW(load_solid(kModels / model.file), UserError) << model.file;
    }
  }
}

TEST(Models, FileWithTwoObjectsNeedsAName) {
  EXPECT_DOUBLE_EQ(load_solid(kModels / "two_objects.3ds", "box").volume, 1.0);
  try {
    load_solid(kModels / "two_objects.3ds");
    FAIL() << "chose an object without a name";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("holds 2 objects: 'box', 'ball'"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(load_solid(kModels / "two_objects.3ds", "cone"), UserError);
}

}  // namespace
}  // namespace tumble::testing
