// A chain is expanded into bodies and the springs, rods or joints between them.
//
//   rods, springs:  anchor --- link_1 --- link_2 --- ... --- link_n [--- end]      ties between
// centres of mass, spacing apart
//   joints:         anchor o==link_1==o==link_2==o ... ==link_n== [o end]          ties at the
// links' ends, links spacing long
#include <Eigen/Geometry>

#include "framework/core/shortest_turn.h"
#include "framework/scene/load_body.h"
#include "framework/scene/load_links.h"
#include "framework/scene/read_entry.h"
#include "framework/scene/read_json.h"
#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

struct ChainLine {
  Vector3d start_m, direction;
  double spacing_m;
};

class ChainWriter {
 public:
  ChainWriter(const json& value, const Document& document, Anchors& anchors,
              const std::string& pointer, Scene& scene)
      : value_(value),
        document_(document),
        anchors_(anchors),
        pointer_(pointer),
        scene_(scene),
        kind_(value.at("kind")),
        links_(value.at("links")) {}

  void write() {
    refuse_foreign_keys();
    const AnchorSpec from = anchors_.read_anchor(value_.at("from"), pointer_ + "/from");
    std::optional<AnchorSpec> to;
    if (value_.contains("to")) to = anchors_.read_anchor(value_.at("to"), pointer_ + "/to");
    line_ = lay_line(from, to);
    const BodySpec link = read_link();
    AnchorSpec before = from;
    for (int k = 1; k <= links_; ++k) {
      const AnchorSpec here{add_body(link, k), Vector3d::Zero()};
      tie(before, here, k, tie_word() + " to " + here.body);
      before = here;
    }
    if (to) tie(before, *to, links_ + 1, tie_word() + " after " + before.body);
  }

 private:
  bool is_jointed() const { return kind_ == "ball_joints" || kind_ == "hinges"; }
  std::string tie_word() const {
    return kind_ == "rods" ? "rod" : kind_ == "springs" ? "spring" : "joint";
  }

  /// Refuses keys of another kind of chain.
  void refuse_foreign_keys() const {
    for (const char* key : {"stiffness_n_m", "damping_n_s_m", "rest_length_m"})
      if (kind_ != "springs" && value_.contains(key))
        document_.refuse(pointer_ + '/' + key, "a chain of " + kind_ + " has none",
                         "Delete it, or choose \"springs\".");
    if (kind_ == "springs" && !value_.contains("stiffness_n_m"))
      document_.refuse(pointer_, "a chain of springs needs the key 'stiffness_n_m'", "Add it.");
    if (kind_ != "hinges" && value_.contains("axis"))
      document_.refuse(pointer_ + "/axis", "a chain of " + kind_ + " has no axis",
                       "Delete it, or choose \"hinges\".");
    if (kind_ == "hinges" && !value_.contains("axis"))
      document_.refuse(pointer_,
                       "a chain of hinges needs the key 'axis': their direction in the world",
                       "Add it.");
    if (is_jointed() && value_.contains("neighbours_apart"))
      document_.refuse(pointer_ + "/neighbours_apart", "joined bodies never collide", "Delete it.");
    if (value_.at("link").contains("position_m"))
      document_.refuse(pointer_ + "/link/position_m",
                       "the chain determines the positions of its links", "Delete it.");
  }

  ChainLine lay_line(const AnchorSpec& from, const std::optional<AnchorSpec>& to) {
    ChainLine line;
    line.start_m = anchors_.place_at_start(from);
    if (to) {
      for (const char* key : {"direction", "spacing_m"})
        if (value_.contains(key))
          document_.refuse(pointer_ + '/' + key,
                           "the chain ends at \"to\", which says its direction and spacing",
                           "Delete it, or \"to\".");
      const Vector3d whole_m = anchors_.place_at_start(*to) - line.start_m;
      if (whole_m.isZero(0.0))
        document_.refuse(pointer_ + "/to", "the chain ends where it begins", "Give another point.");
      line.direction = whole_m.normalized();
      line.spacing_m = whole_m.norm() / (is_jointed() ? links_ : links_ + 1);
      return line;
    }
    for (const char* key : {"direction", "spacing_m"})
      if (!value_.contains(key))
        document_.refuse(pointer_, std::string("key '") + key + "' is missing",
                         "Give direction and spacing_m, or \"to\".");
    line.direction = read_vector(value_.at("direction"));
    if (line.direction.isZero(0.0))
      document_.refuse(pointer_ + "/direction", "found the zero vector, expected a direction");
    line.direction.normalize();
    line.spacing_m = value_.at("spacing_m");
    return line;
  }

  BodySpec read_link() const {
    BodySpec link = read_body(value_.at("link"), document_, pointer_ + "/link");
    if (value_.contains("along")) {
      const std::string along = value_.at("along");
      const Vector3d axis = along == "x"   ? Vector3d::UnitX()
                            : along == "y" ? Vector3d::UnitY()
                                           : Vector3d::UnitZ();
      link.world_from_body =
          shortest_turn(link.world_from_body * axis, line_.direction) * link.world_from_body;
    }
    return link;
  }

  /// @return the name of link k (from 1)
  std::string add_body(BodySpec body, int k) {
    body.name += '_' + std::to_string(k);
    body.position_m =
        line_.start_m + (k - (is_jointed() ? 0.5 : 0.0)) * line_.spacing_m * line_.direction;
    if (value_.contains("colors")) {
      const json& colors = value_.at("colors");
      body.color = read_color(colors.at(static_cast<std::size_t>(k - 1) % colors.size()));
    }
    scene_.bodies.push_back(body);
    return body.name;
  }

  /// The k-th connection (from 1), between the bodies before and after it.
  void tie(const AnchorSpec& a, const AnchorSpec& b, int k, const std::string& name) {
    const double distance_m = (anchors_.place_at_start(b) - anchors_.place_at_start(a)).norm();
    if (kind_ == "rods") {
      add_entry("rods",
                {{"name", name}, {"a", json_of(a)}, {"b", json_of(b)}, {"length_m", distance_m}});
    } else if (kind_ == "springs") {
      json entry{
          {"name", name}, {"a", json_of(a)}, {"b", json_of(b)}, {"rest_length_m", distance_m}};
      for (const char* key : {"stiffness_n_m", "damping_n_s_m", "rest_length_m"})
        if (value_.contains(key)) entry[key] = value_.at(key);
      add_entry("springs", entry);
    } else {
      add_joint(a, b, k, name);
    }
    if (value_.value("neighbours_apart", false) && !a.body.empty() && !b.body.empty())
      scene_.apart.emplace_back(a.body, b.body);
  }

  /// Adds an entry as in a file, with the chain's own position for messages.
  void add_entry(const char* key, const json& entry) {
    const Words* words = words_of(key);
    if (words == nullptr)
      document_.refuse(pointer_ + "/kind",
                       std::string("this program is built without \"") + key + "\"");
    EntrySource source{entry, document_, anchors_};
    Entry read(source, pointer_, 1);
    words->read(read, scene_);
  }

  void add_joint(const AnchorSpec& a, const AnchorSpec& b, int k, const std::string& name) {
    // the world is always the second
    json entry{{"name", name},
               {"kind", kind_ == "hinges" ? "hinge" : "ball"},
               {"body_a", a.body.empty() ? b.body : a.body},
               {"point_m",
                json_of(Vector3d(line_.start_m + (k - 1) * line_.spacing_m * line_.direction))}};
    if (!a.body.empty() && !b.body.empty()) entry["body_b"] = b.body;
    if (kind_ == "hinges") entry["axis"] = value_.at("axis");
    add_entry("joints", entry);
  }

  const json& value_;
  const Document& document_;
  Anchors& anchors_;
  std::string pointer_;
  Scene& scene_;
  std::string kind_;
  int links_;
  ChainLine line_;
};

}  // namespace

void read_chains(const Document& document, Anchors& anchors, Scene& scene) {
  if (!document.json.contains("chains")) return;
  const json& chains = document.json.at("chains");
  for (std::size_t i = 0; i < chains.size(); ++i)
    ChainWriter(chains.at(i), document, anchors, "/chains/" + std::to_string(i), scene).write();
}

}  // namespace tumble::scene
