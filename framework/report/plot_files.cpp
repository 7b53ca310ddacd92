#include "framework/report/plot_files.h"

#include <cctype>
#include <map>

#include <fmt/format.h>

#include "framework/report/plot.h"

namespace tumble::report {
namespace {

constexpr std::string_view kBegin = "<svg class=\"plot\" viewBox=\"0 0 ", kEnd = "</svg>",
                           kLabel = "aria-label=\"";

std::string name_of(const std::string& title) {
  std::string name;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      name += static_cast<char>(std::tolower(c));
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name.empty() ? "plot" : name;
}

std::string without_escapes(std::string words) {
  for (const auto& [escaped, letter] :
       {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "&"}})
    for (std::size_t at = 0; (at = words.find(escaped, at)) != words.npos; ++at)
      words.replace(at, std::string_view(escaped).size(), letter);
  return words;
}

PlotDocument document_of(std::string_view plot) {
  const std::string_view after = plot.substr(kBegin.size());
  const std::string_view size = after.substr(0, after.find('"'));  // "640 360"
  const std::string_view labelled = plot.substr(plot.find(kLabel) + kLabel.size());
  const std::size_t space = size.find(' ');
  PlotDocument document;
  document.title = without_escapes(std::string(labelled.substr(0, labelled.find('"'))));
  document.svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "width=\"{}\" height=\"{}\" {}\n<style>{}</style>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#fff\"/>{}\n",
      size.substr(0, space), size.substr(space + 1), plot.substr(5, plot.find('>') - 4),
      plot_style(), plot.substr(plot.find('>') + 1));
  return document;
}

}  // namespace

std::vector<PlotDocument> plots_in(std::string_view page) {
  std::vector<PlotDocument> plots;
  std::map<std::string, int> taken;
  for (std::size_t begin = 0; (begin = page.find(kBegin, begin)) != page.npos;) {
    const std::size_t end = page.find(kEnd, begin);
    if (end == page.npos) break;
    plots.push_back(document_of(page.substr(begin, end + kEnd.size() - begin)));
    const std::string name = name_of(plots.back().title);
    const int times = ++taken[name];
    plots.back().name = times == 1 ? name : fmt::format("{}_{}", name, times);
    begin = end;
  }
  return plots;
}

}  // namespace tumble::report
