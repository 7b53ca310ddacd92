// validate_platform PLATFORM PATH: whether what an autograder wrote is in the platform's format.
// Prints each broken rule; then, in one line, the score that the platform would show.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "tests/platforms/format_rules.h"

namespace {

namespace fs = std::filesystem;
using namespace tumble::grading;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Result {
  Faults faults;
  std::string score;
};

double sum_of(const nlohmann::json& list) {
  double sum = 0.0;
  for (const auto& each : list)
    sum += each.is_object() ? each.value("score", 0.0) : each.get<double>();
  return sum;
}

std::string words(double score) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", score);
  return text;
}

Result result_of(const std::string& platform, const fs::path& path) {
  using Json = nlohmann::json;
  if (platform == "gradescope") {
    const std::string text = text_of(path);
    Result result{faults_of_gradescope(text), ""};
    if (!result.faults.empty()) return result;
    if (!student_sees_total(text)) result.faults.push_back("hides the total from the student");
    result.score = words(Json::parse(text)["score"].get<double>());
    return result;
  }
  if (platform == "artemis") {
    const std::string xml = text_of(path / "results/tumble.xml");
    std::map<std::string, std::string> feedback;
    for (const auto& entry : fs::directory_iterator(path / "customFeedbacks"))
      feedback["customFeedbacks/" + entry.path().filename().string()] = text_of(entry.path());
    Result result{faults_of_junit(xml), ""};
    for (const std::string& fault : faults_of_custom_feedback(feedback))
      result.faults.push_back(fault);
    // Artemis adds up the points of passed cases.
    double score = 0.0;
    for (std::size_t at = 0; (at = xml.find("name=\"score\" value=\"", at)) != std::string::npos;) {
      at += 20;
      score += std::stod(xml.substr(at));
    }
    result.score = words(score);
    return result;
  }
  if (platform == "github-classroom") {
    std::string text = text_of(path);
    while (text.ends_with('\n')) text.pop_back();
    Result result{faults_of_github_classroom(text), ""};
    if (result.faults.empty()) result.score = words(sum_of(Json::parse(decoded(text))["tests"]));
    return result;
  }
  if (platform == "autolab") {
    const std::string text = text_of(path);
    Result result{faults_of_autolab(text), ""};
    if (result.faults.empty()) result.score = words(sum_of(Json::parse(last_line(text))["scores"]));
    return result;
  }
  return {{"no platform " + platform}, ""};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "validate_platform PLATFORM PATH\n"), 2;
  try {
    const Result result = result_of(argv[1], argv[2]);
    for (const std::string& fault : result.faults) std::printf("%s\n", fault.c_str());
    std::printf("%s\n", result.score.c_str());
    return result.faults.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    return std::printf("%s\n", error.what()), 1;
  }
}
