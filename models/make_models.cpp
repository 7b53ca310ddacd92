// make_models [FOLDER]: writes every model of the catalogue, the same bytes each time. FOLDER
// defaults to models/ of the source tree.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "framework/core/files.h"
#include "models/catalogue.h"

int main(int argc, char** argv) {
  try {
    const std::filesystem::path folder = argc > 1 ? argv[1] : TUMBLE_SOURCE_DIR "/models";
    for (const auto& models : {tumble::models::catalogue(), tumble::models::broken_catalogue()}) {
      for (const auto& model : models) {
        const std::string bytes = tumble::models::write_3ds(model.objects);
        tumble::write_whole(folder / model.file, bytes);
        std::printf("%-32s %6zu bytes\n", model.file.c_str(), bytes.size());
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_models: %s\n", error.what());
    return 1;
  }
}
