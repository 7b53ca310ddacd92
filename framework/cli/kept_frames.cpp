#include "framework/cli/kept_frames.h"

#include <fmt/format.h>

#include "framework/trajectory/trajectory.h"

namespace tumble::cli {
namespace {

constexpr double kMuchMemory = 1e9;  // bytes: what a small machine has left

// Without links and contacts.
double bytes_of_frame(std::size_t bodies) {
  return static_cast<double>(sizeof(Frame) + bodies * sizeof(BodyPose));
}

}  // namespace

KeptFrames kept_frames(double rate_hz, double duration_s, std::size_t bodies, bool is_shown) {
  KeptFrames kept{rate_hz, "", ""};
  if (!is_shown && duration_s > kOrdinaryRun) {
    kept.rate_hz = rate_hz * kOrdinaryRun / duration_s;
    kept.notice = fmt::format(
        "beyond {:g} s a run keeps as many frames as one of that length, here one in {:.3g} s: "
        "they are what checks look at. --trajectory, --html and --video keep {:g} a second",
        kOrdinaryRun, 1.0 / kept.rate_hz, rate_hz);
  }
  const double bytes = kept.rate_hz * duration_s * bytes_of_frame(bodies);
  if (bytes > kMuchMemory)
    kept.warning = fmt::format(
        "{:.3g} frames of {} {} take {:.2g} GB of memory. {}", kept.rate_hz * duration_s, bodies,
        bodies == 1 ? "body" : "bodies", bytes / 1e9,
        is_shown && duration_s > kOrdinaryRun
            ? "A run without files and pictures keeps fewer frames; so does a shorter --duration-s"
            : "A shorter --duration-s or fewer bodies take less");
  return kept;
}

}  // namespace tumble::cli
