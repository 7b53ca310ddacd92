#include "framework/cli/sweep_values.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"
#include "framework/dynamics/methods.h"
#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/engines/run.h"
#include "framework/sampling/worlds.h"
#include "framework/scene/scene_schema.h"
#include "framework/scene/write_entries.h"

namespace tumble::cli {
namespace {

constexpr std::size_t kMostPoints = 10000;  // a file and a row each
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a word may be.
struct Known {
  std::string word, unit;
  double low = -kInfinity, high = kInfinity;
  bool is_open = false;  // `low` itself is not allowed
  bool is_number = true;
};

const std::vector<Known>& scene_wide() {
  static const std::vector<Known> known = {{"restitution", "", 0.0, 1.0},
                                           {"friction", "", 0.0},
                                           {"gravity", "m/s^2", 0.0},
                                           {"step_s", "s", 0.0, kInfinity, true},
                                           {"tolerance", "", 0.0, kInfinity, true},
                                           {"method", "", 0.0, 0.0, false, false},
                                           {"engine", "", 0.0, 0.0, false, false}};
  return known;
}

/// What may be varied of a body: the words that a scene may perturb.
const std::vector<std::string>& of_bodies() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> found;
    const std::function<void(const nlohmann::json&)> look = [&](const nlohmann::json& value) {
      if (value.is_object() && value.contains("properties") &&
          value.at("properties").contains("what") && found.empty())
        found = value.at("properties").at("what").at("enum").get<std::vector<std::string>>();
      if (value.is_structured())
        for (const auto& part : value) look(part);
    };
    look(nlohmann::json::parse(scene::kSceneSchema));
    return found;
  }();
  return words;
}

std::string unit_of(const std::string& what) {
  for (const auto& [ending, unit] : {std::pair{"_rad_s", "rad/s"}, std::pair{"_m_s", "m/s"},
                                     std::pair{"_rad", "rad"}, std::pair{"_m", "m"}})
    if (what.ends_with(ending)) return unit;
  return "";
}

std::string flag(const std::string& said) { return "--over " + said; }

std::string known_words() {
  std::vector<std::string> words;
  for (const Known& known : scene_wide()) words.push_back(known.word);
  return fmt::format("Known: {}, and BODY.WHAT with WHAT one of {}.", fmt::join(words, ", "),
                     fmt::join(of_bodies(), ", "));
}

Known known_of(const std::string& said, const std::string& word, const scene::Scene& scene) {
  for (const Known& known : scene_wide())
    if (known.word == word) return known;
  const std::size_t dot = word.rfind('.');
  if (dot == std::string::npos) {
    std::vector<std::string> words;
    for (const Known& known : scene_wide()) words.push_back(known.word);
    throw UserError(flag(said), "'" + word + "' cannot be varied." + did_you_mean(word, words),
                    known_words());
  }
  const std::string name = word.substr(0, dot), what = word.substr(dot + 1);
  const scene::BodySpec* body = nullptr;
  std::vector<std::string> names;
  for (const scene::BodySpec& one : scene.bodies) {
    names.push_back(one.name);
    if (one.name == name) body = &one;
  }
  if (body == nullptr)
    throw UserError(flag(said), "the scene has no body '" + name + "'." + did_you_mean(name, names),
                    names.size() <= 20 ? fmt::format("Known: {}.", fmt::join(names, ", "))
                                       : fmt::format("It has {}.", names.size()));
  const auto& whats = of_bodies();
  if (std::find(whats.begin(), whats.end(), what) == whats.end())
    throw UserError(flag(said),
                    "'" + what + "' of a body cannot be varied." + did_you_mean(what, whats),
                    fmt::format("Known: {}.", fmt::join(whats, ", ")));
  if (body->immovable && what.find("velocity") != std::string::npos)
    throw UserError(flag(said), "'" + name + "' is immovable and has no velocity",
                    "Vary a movable body's.");
  Known known{word, unit_of(what)};
  if (what == "restitution") known = {word, "", 0.0, 1.0};
  if (what == "friction") known = {word, "", 0.0};
  return known;
}

double number_of(const std::string& said, const std::string& text) {
  const auto read = [&](const std::string& part) {
    char* end = nullptr;
    const double value = std::strtod(part.c_str(), &end);
    if (part.empty() || *end != '\0' || !std::isfinite(value))
      throw UserError(flag(said), "'" + text + "' is no number",
                      "Give numbers or fractions, such as 0.5,1e-3,1/240, or a range 0:1:0.05.");
    return value;
  };
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return read(text);
  const double below = read(text.substr(slash + 1));
  if (below == 0.0) throw UserError(flag(said), "'" + text + "' divides by 0", "Give a number.");
  return read(text.substr(0, slash)) / below;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

[[noreturn]] void refuse_many(const std::string& said, double points) {
  throw UserError(flag(said),
                  fmt::format("the grid has {:.0f} points, and at most {} are made at once", points,
                              kMostPoints),
                  "Take longer steps or fewer words, or several sweeps with --out folders of "
                  "their own.");
}

/// START:END:STEP. Values are rounded to 12 digits, so that 0:1:0.05 holds 0.15 and not
/// 0.15000000000000002.
void add_range(const std::string& said, const std::vector<std::string>& parts, Varied& varied) {
  if (parts.size() != 3)
    throw UserError(flag(said), "a range is START:END:STEP", "For example restitution=0:1:0.05.");
  const double start = number_of(said, parts[0]), end = number_of(said, parts[1]),
               step = number_of(said, parts[2]);
  if (!(step > 0.0) || end < start)
    throw UserError(flag(said),
                    end < start ? "the range is reversed: its end is below its start"
                                : "the range has no step above 0",
                    "Write it upwards, such as 0:1:0.05.");
  constexpr double kRounding = 1e-9;  // of a step: 0:1:0.1 ends with 1
  const double steps = std::floor((end - start) / step + kRounding);
  if (steps + 1.0 > static_cast<double>(kMostPoints)) refuse_many(said, steps + 1.0);
  if (start + steps * step < end - kRounding * step)
    fmt::print(stderr,
               "tumble: {}: the range ends at {:.12g}, since steps of {:g} do not meet {:g}\n",
               flag(said), start + steps * step, step, end);
  for (int i = 0; i <= static_cast<int>(steps); ++i)
    varied.numbers.push_back(std::stod(fmt::format("{:.12g}", start + i * step)));
}

void check_numbers(const std::string& said, const Known& known, const Varied& varied) {
  for (const double value : varied.numbers) {
    const bool is_in =
        (known.is_open ? value > known.low : value >= known.low) && value <= known.high;
    if (is_in) continue;
    const std::string range =
        std::isfinite(known.high)
            ? fmt::format("from {:g} to {:g}", known.low, known.high)
            : fmt::format("{} {:g}", known.is_open ? "above" : "at least", known.low);
    throw UserError(
        flag(said), fmt::format("{} cannot be {:g}", known.word, value),
        "It has to be " + range +
            (known.word == "gravity" ? ": it is a size, along the scene's own direction." : "."));
  }
}

void check_texts(const std::string& said, const Varied& varied) {
  std::vector<std::string> words;
  if (varied.word == "method") {
    for (const std::string& text : varied.texts) method_named(text);
    return;
  }
  for (const auto& [word, meaning] : engines::engine_words()) words.push_back(word);
  for (const std::string& text : varied.texts)
    if (std::find(words.begin(), words.end(), text) == words.end())
      throw UserError(flag(said), "there is no engine '" + text + "'." + did_you_mean(text, words),
                      fmt::format("Known: {}.", fmt::join(words, ", ")));
}

Varied varied_of(const std::string& said, const scene::Scene& scene) {
  const std::size_t equals = said.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UserError(flag(said), "expected WORD=VALUES",
                    "For example restitution=0:1:0.05 or step_s=1e-3,5e-4.");
  Varied varied;
  varied.word = said.substr(0, equals);
  const std::string values = said.substr(equals + 1);
  const Known known = known_of(said, varied.word, scene);
  varied.unit = known.unit;
  varied.is_number = known.is_number;
  if (values.empty())
    throw UserError(flag(said), "no value stands after '='", "Give a range or a list.");
  if (!varied.is_number) {
    varied.texts = split(values, ',');
    check_texts(said, varied);
  } else {
    for (const std::string& part : split(values, ',')) {
      if (part.find(':') != std::string::npos)
        add_range(said, split(part, ':'), varied);
      else
        varied.numbers.push_back(number_of(said, part));
    }
    check_numbers(said, known, varied);
    const bool is_friction = varied.word == "friction" || varied.word.ends_with(".friction");
    if (is_friction && !scene.contact &&
        std::any_of(varied.numbers.begin(), varied.numbers.end(),
                    [](double value) { return value > 0.0; }))
      throw UserError(flag(said),
                      "friction acts in persistent contact only, and the scene has none",
                      "Add \"contact\": {} to the scene.");
    for (const double value : varied.numbers) varied.texts.push_back(fmt::format("{}", value));
  }
  std::vector<std::string> sorted = varied.texts;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    throw UserError(flag(said), "the value " + *twice + " is given twice", "Give it once.");
  return varied;
}

/// "a=1,2,b=3" is "a=1,2" and "b=3": a part with '=' begins the next word.
std::vector<std::string> each_of(const std::vector<std::string>& over) {
  std::vector<std::string> all;
  for (const std::string& said : over) {
    bool is_first = true;
    for (const std::string& part : split(said, ',')) {
      if (is_first || part.find('=') != std::string::npos)
        all.push_back(part);
      else
        all.back() += ',' + part;
      is_first = false;
    }
  }
  return all;
}

const std::string kGravity = "gravity_m_s2";  // of a scene file

/// The direction of the scene's gravity; down where it has none. Unit, world.
Vector3d way_of_gravity(const scene::Scene& scene) {
  scene::Scene bare;
  bare.effects = scene.effects;
  for (const effects::Effect* effect : effects::all())
    if (effect->key() != kGravity) effect->clear(bare);
  const Vector3d own = build_world(bare).gravity_world.value_or(Vector3d::Zero());
  return own.norm() > 0.0 ? own.normalized() : Vector3d(0.0, 0.0, -1.0);
}

}  // namespace

std::string value_in_words(const Varied& varied, std::size_t value) {
  if (!varied.is_number) return varied.texts[value];
  const double number = varied.numbers[value];
  const std::string digits = few_digits(number, 6);
  const bool is_long = digits.size() > 5;  // 0.005 is read as it is, 0.0166667 as 1/60
  return varied.word == "step_s" && is_long ? step_in_words(number) : digits;
}

std::vector<Varied> parse_over(const std::vector<std::string>& over, const scene::Scene& scene) {
  std::vector<Varied> all;
  double points = 1.0;
  for (const std::string& said : each_of(over)) {
    Varied varied = varied_of(said, scene);
    for (const Varied& other : all)
      if (other.word == varied.word)
        throw UserError(flag(said), "'" + varied.word + "' is varied twice",
                        "Give all of its values in one list.");
    points *= static_cast<double>(varied.size());
    if (points > static_cast<double>(kMostPoints)) refuse_many(said, points);
    all.push_back(std::move(varied));
  }
  return all;
}

std::vector<GridPoint> grid_of(const std::vector<Varied>& varied) {
  std::vector<GridPoint> points(1);
  for (const Varied& one : varied) {
    std::vector<GridPoint> longer;
    for (const GridPoint& point : points)
      for (std::size_t i = 0; i < one.size(); ++i) {
        longer.push_back(point);
        longer.back().push_back(i);
      }
    points = std::move(longer);
  }
  return points;
}

std::string in_words(const std::vector<Varied>& varied, const GridPoint& point) {
  std::string text;
  for (std::size_t i = 0; i < varied.size(); ++i)
    text += fmt::format("{}{}={}", i == 0 ? "" : ", ", varied[i].word, varied[i].texts[point[i]]);
  return text;
}

void set_words(const std::vector<Varied>& varied, const GridPoint& point, RunWords& words) {
  for (std::size_t i = 0; i < varied.size(); ++i) {
    const Varied& one = varied[i];
    if (one.word == "method") words.method = one.texts[point[i]];
    if (one.word == "engine") words.engine = one.texts[point[i]];
    if (one.word == "step_s") words.step_s = one.numbers[point[i]];
    if (one.word == "tolerance") words.tolerance = one.numbers[point[i]];
  }
  // A method that takes the step of the scene has no tolerance.
  if (!words.method.empty() && !method_named(words.method).controlled) words.tolerance.reset();
}

// Words of all bodies come before those of one, which say more.
void set_scene(const std::vector<Varied>& varied, const GridPoint& point, scene::Scene& scene) {
  std::vector<std::size_t> order(varied.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
    return varied[i].word.find('.') == std::string::npos;
  });
  for (const std::size_t i : order) {
    const std::string& word = varied[i].word;
    const std::size_t dot = word.rfind('.');
    if (!varied[i].is_number) continue;
    const double value = varied[i].numbers[point[i]];
    if (word == "restitution") {
      for (scene::BodySpec& body : scene.bodies) body.restitution = value;
    } else if (word == "friction") {
      for (scene::BodySpec& body : scene.bodies) body.friction = value;
    } else if (word == "gravity") {
      const Vector3d along = way_of_gravity(scene);
      scene::remove_entries(scene, kGravity);
      scene::EntryWriter write(scene);
      write(kGravity, value * along);
    } else if (dot != std::string::npos) {
      scene::PerturbationSpec spec;
      spec.body = word.substr(0, dot);
      spec.what = word.substr(dot + 1);
      scene = sampling::world_of({scene, {{spec}, {}}}, VectorXd::Constant(1, value));
    }
  }
}

}  // namespace tumble::cli
