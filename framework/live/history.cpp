#include "framework/live/history.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/live/records.h"
#include "framework/report/channels.h"

namespace tumble::live {
namespace {

using Json = nlohmann::ordered_json;

Vector3d vector_from(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::vector<double> numbers_of(const std::string& packed) {
  std::vector<double> numbers(packed.size() / sizeof(double));
  std::memcpy(numbers.data(), packed.data(), numbers.size() * sizeof(double));
  return numbers;
}

}  // namespace

History::History(std::string head, std::size_t most_bytes)
    : head_(std::move(head)), most_bytes_(most_bytes) {
  const Json json = Json::parse(head_), &scene = json.at("scene");
  if (scene.contains("origin")) origin_world_ = vector_from(scene.at("origin"));
  outline_.camera.eye_m = vector_from(scene.at("camera").at("eye"));
  outline_.camera.target_m = vector_from(scene.at("camera").at("target"));
  for (const Json& body : scene.at("bodies")) {
    scene::BodySpec spec;
    spec.name = body.at("name");
    spec.immovable = body.at("immovable");
    outline_.bodies.push_back(std::move(spec));
    radii_.push_back(body.at("radius").is_null() ? std::numeric_limits<double>::infinity()
                                                 : body.at("radius").get<double>());
  }
}

// Once full it stays so until it is cut: a run with gaps is not the run.
bool History::has_room_for(const std::string& bytes) {
  is_full_ = is_full_ || bytes_ + bytes.size() > most_bytes_;
  if (!is_full_) bytes_ += bytes.size();
  return !is_full_;
}

std::string History::limit_in_words() const {
  if (!is_full_) return "";
  return fmt::format(
      "The run is kept up to {:.6g} s only, because it has more than {} MB: what comes later is "
      "shown, but neither saved nor compared.",
      end_s(), most_bytes_ >> 20);
}

void History::add_frame(std::string bytes) {
  if (has_room_for(bytes)) frames_.push_back(std::move(bytes));
}

void History::add_event(std::string bytes) {
  if (has_room_for(bytes)) events_.push_back(std::move(bytes));
}

void History::cut(double time_s) {
  constexpr double kRounding = 1e-9;  // s, of frame times
  const auto is_later = [&](const std::string& packed) {
    return time_of(packed) >= time_s - kRounding;
  };
  for (std::vector<std::string>* list : {&frames_, &events_}) {
    const auto first = std::find_if(list->begin(), list->end(), is_later);
    for (auto it = first; it != list->end(); ++it) bytes_ -= it->size();
    list->erase(first, list->end());
  }
  is_full_ = false;
}

double History::time_of(const std::string& packed) {
  double time = 0.0;
  std::memcpy(&time, packed.data(), std::min(sizeof time, packed.size()));
  return time;
}

Trajectory History::part(double from_s, double until_s) const {
  Trajectory run;
  for (const scene::BodySpec& body : outline_.bodies)
    run.bodies.push_back({body.name, body.immovable});
  const auto is_before = [](const std::string& packed, double time) {
    return time_of(packed) < time;
  };
  const auto first = std::lower_bound(frames_.begin(), frames_.end(), from_s, is_before);
  for (auto it = first; it != frames_.end() && time_of(*it) < until_s; ++it)
    run.frames.push_back(unpack_frame(*it));
  for (const std::string& event : events_)
    if (time_of(event) >= from_s && time_of(event) < until_s)
      run.events.push_back(unpack_event(event));
  return run;
}

namespace {

std::string as_floats(const std::vector<double>& numbers) {
  std::vector<float> floats;
  for (const double x : numbers) floats.push_back(static_cast<float>(x));
  return report::base64(
      {reinterpret_cast<const char*>(floats.data()), floats.size() * sizeof(float)});
}

}  // namespace

std::string frame_for_page(const std::string& packed, const std::string& first,
                           const Vector3d& origin_world) {
  Frame frame = unpack_frame(packed);
  for (BodyPose& pose : frame.poses) pose.com_world -= origin_world;
  for (ContactPoint& contact : frame.contacts) contact.point_world -= origin_world;
  std::vector<double> numbers = numbers_of(pack(frame));
  const Frame start = unpack_frame(first);
  numbers.push_back(frame.kinetic_energy + frame.potential_energy -
                    (start.kinetic_energy + start.potential_energy));
  return as_floats(numbers);
}

std::string event_for_page(const std::string& packed, const Vector3d& origin_world) {
  Event event = unpack_event(packed);
  event.point_world -= origin_world;
  return as_floats(numbers_of(pack(event)));
}

}  // namespace tumble::live
