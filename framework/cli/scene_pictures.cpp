#include "framework/cli/scene_pictures.h"

namespace tumble::cli {

void write_pictures(const Context&, const scene::Scene&, const Trajectory&, const RunWords& words, const PictureSize&) {
  if (!words.png.empty() || !words.sheet.empty() || !words.video.empty()) throw UserError("--png, --sheet, --video", "pictures cannot be drawn yet");
}

}  // namespace tumble::cli
