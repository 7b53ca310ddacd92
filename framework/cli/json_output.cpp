#include "framework/cli/json_output.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "framework/core/version.h"

namespace tumble::cli {

std::string json_text(const nlohmann::ordered_json& page, int indent) {
  return page.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void print_json(const Command& command, const nlohmann::ordered_json& parts) {
  using Json = nlohmann::ordered_json;
  Json all{{"command", command.command_line}, {"version", kProgramVersion}};
  all.update(parts);
  std::printf("%s\n", json_text(all, 1).c_str());
}

}  // namespace tumble::cli
