#include "framework/cli/json_output.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "framework/core/version.h"

namespace tumble::cli {

void print_json(const Command& command, const nlohmann::ordered_json& parts) {
  using Json = nlohmann::ordered_json;
  Json all{{"command", command.command_line}, {"version", kProgramVersion}};
  all.update(parts);
  std::printf("%s\n", all.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
}

}  // namespace tumble::cli
