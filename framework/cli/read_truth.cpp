#include "framework/cli/read_truth.h"

#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"

namespace tumble::cli {
namespace {

using Json = nlohmann::ordered_json;
using truths::Value;

Value to_value(const Json& json, const std::string& place) {
  switch (json.type()) {
    case Json::value_t::null: return {place, std::monostate{}};
    case Json::value_t::boolean: return {place, json.get<bool>()};
    case Json::value_t::string: return {place, json.get<std::string>()};
    case Json::value_t::array: {
      Value::List items;
      for (std::size_t i = 0; i < json.size(); ++i)
        items.push_back(to_value(json[i], place + "/" + std::to_string(i)));
      return {place, std::move(items)};
    }
    case Json::value_t::object: {
      Value::Members members;
      for (const auto& [name, member] : json.items())
        members.emplace_back(name, to_value(member, place + "/" + name));
      return {place, std::move(members)};
    }
    default: return {place, json.dump()};  // a bare number, as text
  }
}

}  // namespace

truths::Case read_truth(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string(), "cannot be read", "Check the path.");
  Json json;
  try {
    json = Json::parse(stream);
  } catch (const Json::parse_error& error) {
    throw UserError(file.string(), std::string("is not JSON: ") + error.what(),
                    "Copy the truth file again.");
  }
  const Value root = to_value(json, file.string() + ": ");
  truths::Case truth;
  truth.id = root.at("id").text();
  truth.family = root.at("family").text();
  truth.title = root.at("title").text();
  truth.inputs = root.at("inputs");
  truth.outputs = root.at("outputs");
  return truth;
}

std::vector<std::filesystem::path> find_truths(const std::filesystem::path& folder_or_file) {
  namespace fs = std::filesystem;
  if (fs::is_regular_file(folder_or_file)) return {folder_or_file};
  if (!fs::is_directory(folder_or_file))
    throw UserError(folder_or_file.string(), "there is no such folder or file",
                    "Try tests/truths.");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder_or_file)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  if (files.empty())
    throw UserError(folder_or_file.string(), "holds no truth file (*.json)", "Try tests/truths.");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace tumble::cli
