// tumble inspect FILE: the objects of a .3ds file, whether each is a solid, its mass properties,
// and its defects.
#include <cmath>
#include <cstdio>
#include <memory>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/command.h"
#include "framework/cli/find_model.h"
#include "framework/cli/json_output.h"
#include "framework/cli/words.h"
#include "framework/core/terminal.h"
#include "framework/core/version.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/solid.h"

namespace tumble::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kWater = 1000.0;  // kg/m^3
// relative to the largest number beside it: round-off of the integrals
constexpr double kShownAsZero = 1e-12;

struct InspectWords {
  std::string file;
  double metres_per_unit = 1.0;
  double density = kWater;
  bool json = false;
};

/// Colours on a terminal, none in a file or a pipe.
struct Paint {
  bool on = shows_colours(STDOUT_FILENO);
  std::string operator()(const char* code, const std::string& text) const {
    return on ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
  }
  std::string name(const std::string& text) const { return (*this)("1", text); }
  std::string good(const std::string& text) const { return (*this)("32", text); }
  std::string bad(const std::string& text) const { return (*this)("1;31", text); }
  std::string odd(const std::string& text) const { return (*this)("33", text); }
};

/// A word quoted for a shell.
std::string quoted(const std::string& word) {
  if (word.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+=:@%,") ==
          word.npos &&
      !word.empty())
    return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

double clean(double value, double scale) {
  return std::abs(value) <= kShownAsZero * scale ? 0.0 : value;
}

std::string show(const Vector3d& v, double scale) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", clean(v.x(), scale), clean(v.y(), scale),
                     clean(v.z(), scale));
}

void print_row(const char* label, const std::string& text) {
  fmt::print("  {:<16}{}\n", label, text);
}

void print_inertia(const MassProperties& mass) {
  const double scale = mass.inertia_com_mesh.cwiseAbs().maxCoeff();
  for (int row = 0; row < 3; ++row) {
    std::string numbers;
    for (int column = 0; column < 3; ++column)
      numbers += fmt::format("{:>14.6g}", clean(mass.inertia_com_mesh(row, column), scale));
    print_row(row == 0 ? "inertia" : "",
              "[" + numbers + " ]" + (row == 0 ? "  kg m^2, about the centre of mass" : ""));
  }
  for (int i = 0; i < 3; ++i) {
    print_row(i == 0 ? "principal axes" : "",
              fmt::format("{:>14.6g}  kg m^2 about {}", mass.principal_moments[i],
                          show(mass.mesh_from_principal.col(i), 1.0)));
  }
}

void print_object(const LoadedObject& object, double density, const Paint& paint) {
  const ClosedReport& report = object.report;
  const TriangleMesh& mesh = report.mesh;
  const bool is_solid = report.is_closed();
  const std::string verdict =
      !is_solid ? paint.bad("not a solid")
                : paint.good(is_convex(mesh) ? "closed, convex" : "closed, not convex");
  fmt::print("\n{}  {}\n", paint.name(object.name.empty() ? "(no name)" : object.name), verdict);
  print_row("vertices, faces",
            fmt::format("{}, {}{}", mesh.vertices.size(), mesh.faces.size(),
                        report.parts > 1 ? fmt::format(" in {} parts", report.parts) : ""));
  if (!mesh.vertices.empty()) {
    const Bounds bounds = bounds_of(mesh);
    const Vector3d size = bounds.high - bounds.low;
    const double scale =
        std::max(bounds.low.cwiseAbs().maxCoeff(), bounds.high.cwiseAbs().maxCoeff());
    print_row("bounding box",
              fmt::format("{} to {} m", show(bounds.low, scale), show(bounds.high, scale)));
    print_row("size", fmt::format("{:.6g} x {:.6g} x {:.6g} m", size.x(), size.y(), size.z()));
    if (is_solid) {
      const MassProperties mass = compute_mass_properties(mesh, density);
      print_row("volume", fmt::format("{:.6g} m^3", mass.volume));
      print_row("mass", fmt::format("{:.6g} kg", mass.mass));
      print_row("centre of mass", show(mass.com_mesh, scale) + " m");
      print_inertia(mass);
    }
  }
  for (const std::string& notice : report.notices) print_row("notice", paint.odd(notice));
  for (const Defect& defect : report.defects) {
    print_row("wrong", paint.bad(defect.problem));
    print_row("remedy", defect.remedy);
  }
}

template <class Derived>
Json to_json(const Eigen::MatrixBase<Derived>& matrix) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (matrix.cols() == 1)
      list.push_back(matrix(i, 0));
    else
      list.push_back(to_json(matrix.row(i).transpose().eval()));
  }
  return list;
}

Json to_json(const LoadedObject& object, double density) {
  const ClosedReport& report = object.report;
  Json json{{"name", object.name},
            {"closed", report.is_closed()},
            {"vertices", report.mesh.vertices.size()},
            {"faces", report.mesh.faces.size()},
            {"parts", report.parts},
            {"notices", report.notices},
            {"defects", Json::array()}};
  for (const Defect& defect : report.defects)
    json["defects"].push_back({{"problem", defect.problem}, {"remedy", defect.remedy}});
  if (!report.mesh.vertices.empty()) {
    const Bounds bounds = bounds_of(report.mesh);
    json["bounding_box_m"] = {{"low", to_json(bounds.low)}, {"high", to_json(bounds.high)}};
  }
  if (!report.is_closed()) return json;
  const MassProperties mass = compute_mass_properties(report.mesh, density);
  json["convex"] = is_convex(report.mesh);
  json["volume_m3"] = mass.volume;
  json["mass_kg"] = mass.mass;
  json["com_mesh_m"] = to_json(mass.com_mesh);
  json["inertia_com_mesh_kg_m2"] = to_json(mass.inertia_com_mesh);
  json["principal_moments_kg_m2"] = to_json(mass.principal_moments);
  json["mesh_from_principal"] = to_json(mass.mesh_from_principal);
  return json;
}

/// The next commands: for a solid model, to see it move.
void print_next(const InspectWords& words, const std::filesystem::path& path) {
  const std::string scale =
      words.metres_per_unit == 1.0 ? "" : fmt::format(" --scale {:g}", words.metres_per_unit);
  const std::string density =
      words.density == kWater ? "" : fmt::format(" --density {:g}", words.density);
  const std::string rest = quoted(path.string()) + scale + density;
  fmt::print(
      "\nsee it move:  tumble run {} --html model.html     (--drop: onto a floor)\npush it:      "
      "tumble poke {} --pixel 320,240 --force 0,1,0 --duration-s 0.2 --html poke.html\n",
      rest, rest);
}

ExitCode inspect(const Command& command, const InspectWords& words) {
  const auto path = find_model_file(command, words.file);
  const LoadedFile file = load_3ds(path, {words.metres_per_unit});
  std::size_t closed = 0;
  for (const LoadedObject& object : file.objects) closed += object.report.is_closed() ? 1 : 0;

  if (words.json) {
    Json all{{"command", command.command_line},
             {"version", kProgramVersion},
             {"file", file.where},
             {"metres_per_unit", words.metres_per_unit},
             {"density_kg_m3", words.density},
             {"objects", Json::array()}};
    for (const LoadedObject& object : file.objects)
      all["objects"].push_back(to_json(object, words.density));
    fmt::print("{}\n", json_text(all, 1));
  } else {
    const Paint paint;
    const std::size_t n = file.objects.size();
    fmt::print("{}\n{} object{}{} · 1 unit = {:g} m · density {:g} kg/m^3\n", file.where, n,
               n == 1 ? "" : "s",
               closed == n ? ""
                           : paint.bad(n == 1 ? ", not a solid"
                                              : fmt::format(", {} of them not solid", n - closed)),
               words.metres_per_unit, words.density);
    for (const LoadedObject& object : file.objects) print_object(object, words.density, paint);
    if (closed == n) print_next(words, path);
  }
  return closed == file.objects.size() ? ExitCode::kFine : ExitCode::kCheckFailed;
}

}  // namespace

void add_inspect(CLI::App& app, Command& command) {
  auto words = std::make_shared<InspectWords>();
  Verb verb(app, "inspect",
            "What a .3ds file holds: is it solid, what does it weigh, what is wrong");
  verb.option("file", words->file, "A .3ds file, or the name of one in models/")
      .required()
      .type_name("FILE");
  verb.option("--scale", words->metres_per_unit, "Length of the file's unit [m]: 0.0254 for inches")
      .shows_default()
      .positive();
  verb.option("--density", words->density, "Density [kg/m^3]").shows_default().positive();
  verb.flag("--json", words->json, "The same for machines, all digits");
  verb.footer(
      "Example: tumble inspect chess_pawn --scale 0.05 --density 700\nExit: 0 every object is a "
      "solid, 1 one is not, 2 the file cannot be read.");
  verb.runs([&command, words] { command.exit = inspect(command, *words); });
}

}  // namespace tumble::cli
