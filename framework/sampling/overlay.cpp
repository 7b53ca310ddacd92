#include "framework/sampling/overlay.h"

#include <algorithm>

#include "framework/core/error.h"

namespace tumble::sampling {

Overlay overlay_of(const scene::Scene& scene, const std::vector<OverlaidRun>& runs) {
  require(!runs.empty(), "an overlay of no runs");
  Overlay overlay{scene, runs.front().run};
  overlay.scene.checks.clear();
  overlay.run.events.clear();
  overlay.scene.bodies.clear();
  overlay.run.bodies.clear();
  struct Source {
    std::size_t run, body;
  };
  std::vector<Source> sources;
  for (std::size_t r = 0; r < runs.size(); ++r)
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      scene::BodySpec body = scene.bodies[b];
      if (body.immovable && r > 0) continue;
      if (r > 0) body.name += " " + std::to_string(r + 1);
      if (!body.immovable) body.color = runs[r].color;
      overlay.run.bodies.push_back({body.name, body.immovable});
      overlay.scene.bodies.push_back(std::move(body));
      sources.push_back({r, b});
    }
  std::size_t frames = runs.front().run.frames.size();
  for (const OverlaidRun& one : runs) frames = std::min(frames, one.run.frames.size());
  overlay.run.frames.resize(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    Frame& frame = overlay.run.frames[f];
    frame.poses.clear();
    frame.contacts.clear();
    for (const Source& source : sources)
      frame.poses.push_back(runs[source.run].run.frames[f].poses[source.body]);
  }
  return overlay;
}

}  // namespace tumble::sampling
