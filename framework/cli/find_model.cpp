#include "framework/cli/find_model.h"

namespace tumble::cli {
namespace fs = std::filesystem;

fs::path find_model_file(const Command& command, const std::string& word) {
  if (fs::is_regular_file(word)) return word;
  for (const std::string& name : {word, word + ".3ds"}) {
    const auto path = command.root / "models" / name;
    if (fs::is_regular_file(path)) return path.lexically_proximate(fs::current_path());
  }
  return word;  // the loader says that it is not there
}

}  // namespace tumble::cli
