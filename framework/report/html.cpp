#include "framework/report/html.h"

#include <algorithm>

#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/report/channels.h"

namespace tumble::report {
namespace {

// No network and no scripts; pictures and video from the page's folder (`file:` for pages opened
// from disk).
constexpr const char* kPolicy =
    "default-src 'none'; img-src 'self' file: data:; media-src 'self' file: data:; style-src "
    "'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'";

// The page's one script, by its digest: no text of a page becomes a script. Workers of the page's
// own text; both may compile WebAssembly, and inherit that there is no network.
std::string policy_for(const std::string& script) {
  if (script.empty()) return kPolicy;
  return std::string(kPolicy) + "; script-src 'sha256-" + base64(digest_bytes(script)) +
         "' 'wasm-unsafe-eval'; worker-src blob:";
}

// A table with more columns has less space between them, so that it fits the page and paper.
constexpr std::size_t kManyColumns = 7;

// Colours have a contrast of at least 4.5:1 to their background and differ in lightness, not only
// in hue.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --paper: #fff; --ink: #1c2733; --soft: #5b6875;
  --line: #d9e0e6; --wash: #f4f7f9; --good: #00664b;
  --warn: #8a5a00; --bad: #a82c00; --link: #005a96; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2.2rem 1.4rem 3rem; max-width: 68rem; color: var(--ink);
  background: var(--paper);
  font: 16px/1.5 "DejaVu Sans", "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
header { border-bottom: 3px solid var(--ink); margin-bottom: 1.4rem; }
h1 { font-size: 1.75rem; margin: 0 0 .2rem; }
header p { margin: 0 0 .8rem; color: var(--soft); overflow-wrap: anywhere; }
h2 { font-size: 1.25rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1.02rem; margin: 1.5rem 0 .4rem; }
h4 { font-size: .93rem; margin: .9rem 0 .25rem; } .story h4:first-child { margin-top: .1rem; }
p { max-width: 52rem; } a { color: var(--link); } nav { margin: .8rem 0 1.1rem; }
nav a { margin-right: 1.2rem; }
.wide { overflow-x: auto; margin: .8rem 0 1.2rem; }
table { border-collapse: collapse; font-size: .93rem; }
caption { text-align: left; color: var(--soft); padding-bottom: .3rem; }
th, td { padding: .32rem .8rem; border-bottom: 1px solid var(--line); text-align: left;
  vertical-align: top; }
.many { font-size: .86rem; } .many th, .many td { padding: .3rem .45rem; }
thead th { border-bottom: 2px solid var(--ink); white-space: nowrap; }
tbody tr:nth-child(even) { background: var(--wash); }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.muted { color: var(--soft); } .good { color: var(--good); font-weight: 600; }
.warning { color: var(--warn); font-weight: 600; }
.bad { color: var(--bad); font-weight: 700; }
pre { background: var(--wash); border-left: 4px solid var(--line); padding: .7rem 1rem;
  overflow-x: auto; white-space: pre-wrap; overflow-wrap: anywhere;
  font: .84rem/1.45 "DejaVu Sans Mono", Menlo, Consolas, monospace; }
pre.code { white-space: pre; overflow-wrap: normal; }
.box { border: 1px solid var(--line); border-top: 4px solid var(--bad); padding: .2rem 1.2rem 1rem;
  margin: 1.4rem 0; } .box h2 { border: 0; margin: .8rem 0 .2rem; }
.card { border-top: 1px solid var(--line); margin-top: 1rem; overflow: hidden; }
.card h3 { font-size: 1.1rem; } .card p { margin: .3rem 0; }
.card .figures { float: right; width: 19rem; max-width: 100%; margin: .3rem 0 .6rem 1.2rem; }
@media screen and (max-width: 60rem) { .card .figures { float: none; margin: .6rem 0; } }
details { margin: .5rem 0; } summary { cursor: pointer; font-weight: 600; }
/* as many columns as there is room for, and no last figure larger than those before it */
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(20rem, 100%), 1fr));
  gap: 1.2rem; margin: 1rem 0; }
figure { margin: 0; max-width: 100%; }
figure img, figure video { max-width: 100%; height: auto; display: block;
  border: 1px solid var(--line); } figure .in-print { display: none; }
/* Controls stand below the picture, where they cover no scale of lengths: the hidden picture gives
   the height, the padding has room for them. */
.film { position: relative; width: fit-content; max-width: 100%; padding-bottom: 5rem; }
.film video { position: absolute; inset: 0; width: 100%; height: 100%; object-fit: contain;
  object-position: top; background: #1c2733; box-sizing: border-box; }
figure .film .in-print { display: block; visibility: hidden; }
.wide:focus-visible, summary:focus-visible, a:focus-visible {
  outline: 2px solid var(--link); outline-offset: 2px; }
ul { margin: .4rem 0; padding-left: 1.4rem; }
.thumbs { display: grid; gap: .7rem; grid-template-columns: repeat(auto-fill, minmax(9rem, 1fr)); }
.thumbs figcaption { font-size: .8rem; line-height: 1.3; }
.story { background: var(--wash); border-left: 4px solid var(--line); padding: .6rem 1rem;
  margin: .6rem 0; display: flow-root; } .story pre { border: 0; padding: 0; margin: 0 0 .4rem; }
.fields { display: grid; grid-template-columns: minmax(4.7rem, max-content) minmax(0, 1fr);
  gap: .15rem .9rem; margin: 0; } .fields dt { color: var(--soft); }
.fields dd { margin: 0; white-space: pre-wrap; overflow-wrap: anywhere; }
.fields dd a { white-space: normal; }
.story .wide { margin: .4rem 0 0; } .story table { font-size: .88rem; }
.story td.bad { min-width: 13rem; }
.story td { padding: .18rem .6rem .18rem 0; } .story td:first-child { white-space: nowrap; }
.story td:nth-child(2) { white-space: pre; font-family: "DejaVu Sans Mono", Menlo, Consolas,
  monospace; font-size: .92em; }
.story .plot-figure { float: right; width: 15rem; margin: .2rem 0 .2rem 1rem; }
figure .label { font-weight: 600; margin: 0 0 .3rem; }
.unbroken { white-space: nowrap; }
figcaption { color: var(--soft); font-size: .88rem; margin-top: .35rem; }
.tiles { display: flex; flex-wrap: wrap; gap: 1rem; }
.tile { border: 1px solid var(--line); border-top: 4px solid var(--ink); padding: .6rem 1.1rem;
  min-width: 8rem; }
.tile b { display: block; font-size: 1.5rem; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: .86rem; }
.plot-figure { max-width: 46rem; margin: .8rem 0 1.4rem; }
.plot-figure.small { max-width: 30rem; }
svg.plot { width: 100%; height: auto; display: block; } svg.plot.narrow { display: none; }
@media screen and (max-width: 38rem) { svg.plot.narrow { display: block; max-width: 30rem; }
  .both > svg.plot:not(.narrow) { display: none; } }
footer { margin-top: 2.5rem; border-top: 1px solid var(--line); color: var(--soft);
  font-size: .8rem; overflow-wrap: anywhere; }
@media screen and (prefers-color-scheme: dark) { :root { --paper: #161d24; --ink: #e4eaf0;
  --soft: #a3b0bd; --line: #3a4652; --wash: #1f2831; --good: #5ecfae; --warn: #f0bd5a;
  --bad: #ff8a5c; --link: #7cc0f0; }
  /* lightness turned over, hues kept */
  .plot-figure svg { filter: invert(1) hue-rotate(180deg); }
  svg.plot .halo { stroke: #dbe2e9; } .story svg.plot .halo { stroke: #ced7e0; }
  svg.plot .grid { stroke: #a9b6c2; } }
@media screen and (max-width: 44rem) { body { padding: 1.1rem .9rem 2rem; }
  /* a table wider than the page scrolls, and its caption stays */
  caption span { display: inline-block; position: sticky; left: 0; max-width: calc(100vw - 3rem); }
  th, td { padding: .3rem .35rem; } h1, h2, h3, p, li { overflow-wrap: anywhere; }
  .box { padding: .1rem .7rem .8rem; }
  /* a value has the whole line, below its name */
  .fields { display: block; } .fields dt { font-size: .88rem; margin-top: .3rem; }
  .story table, .story tbody, .story tr, .story td,
  .blocks, .blocks tbody, .blocks tr, .blocks td { display: block; }
  .blocks caption, .story caption { display: block; } .blocks td:empty { display: none; }
  .blocks thead { display: none; } .blocks tr { padding: .35rem 0; }
  .blocks td { border: 0; padding: .1rem .4rem; overflow-wrap: anywhere; }
  .blocks td.number { text-align: left; white-space: normal; }
  .blocks td[data-name]::before { content: attr(data-name) ": "; color: var(--soft);
    font-weight: 400; }
  .story tr { padding: .2rem 0; }
  .story td { padding: 0; border: 0; }
  .story td:nth-child(2) { white-space: pre-wrap; } .story td:first-child { color: var(--soft); }
  .story { padding: .5rem .6rem; } .fields { gap: .15rem .6rem; font-size: .93rem; }
  .story .plot-figure { float: none; margin: .4rem auto; }
  .thumbs { grid-template-columns: repeat(auto-fill, minmax(7rem, 1fr)); } }
@media print { pre.code { white-space: pre-wrap; }
  figure video { display: none; } figure .in-print, figure .film .in-print { display: block;
  visibility: visible; } .film { padding-bottom: 0; }
  .wide { overflow: visible; } table { font-size: 9pt; }
  body { padding: 0; max-width: none; font-size: 11pt; }
  a { color: inherit; text-decoration: none; }
  tr, figure, .tile { break-inside: avoid; } h2, h3 { break-after: avoid; } nav { display: none; }
  details > * { display: block; } .box { break-inside: auto; } }
)";

const char* class_of(Look look) {
  switch (look) {
    case Look::kMuted: return "muted";
    case Look::kGood: return "good";
    case Look::kWarning: return "warning";
    case Look::kBad: return "bad";
    case Look::kPlain: break;
  }
  return "";
}

// A link is a path from link_to or an anchor; a scheme (javascript:, http:) is a bug.
std::string linked(const Cell& cell) {
  if (cell.link.empty()) return html_sentence(cell.text);
  require(cell.link.find(':') == std::string::npos,
          "report: a link must be made by link_to or be \"#id\", not: " + cell.link);
  return "<a href=\"" + html_escape(cell.link) + "\">" + html_escape(cell.text) + "</a>";
}

// Where the text holds a link's text, it leads where the link does.
std::string linked_within(std::string_view text, const std::vector<Cell>& links) {
  std::string html;
  while (!text.empty()) {
    // the next place that leads somewhere
    std::size_t at = text.size();
    const Cell* next = nullptr;
    for (const Cell& link : links)
      if (const auto found = text.find(link.text); !link.text.empty() && found < at)
        at = found, next = &link;
    html += html_sentence(text.substr(0, at));
    if (next != nullptr) html += linked(*next);
    text.remove_prefix(next == nullptr ? at : at + next->text.size());
  }
  return html;
}

std::string class_attribute(Look look, bool is_number = false) {
  std::string classes = class_of(look);
  if (is_number) classes += classes.empty() ? "number" : " number";
  return classes.empty() ? "" : " class=\"" + classes + '"';
}

// A table of sentences does not fit a phone: there each row is a block, and each cell stands below
// its column's name.
bool becomes_blocks(const Table& table) {
  constexpr std::size_t kSentence = 36;  // characters
  if (table.columns.size() < 3 || table.columns.back().name.empty()) return false;
  return std::any_of(table.rows.begin(), table.rows.end(), [](const auto& row) {
    return std::any_of(row.begin(), row.end(),
                       [](const Cell& cell) { return cell.text.size() > kSentence; });
  });
}

std::string name_for_blocks(const std::string& column, bool is_blocks) {
  return is_blocks && !column.empty() ? " data-name=\"" + html_escape(column) + '"' : "";
}

std::string figure_html(const Figure& figure) {
  std::string html = "<figure>";
  if (!figure.label.empty()) html += "<p class=\"label\">" + html_escape(figure.label) + "</p>";
  const std::string alt = html_escape(figure.caption);
  if (!figure.video.empty()) {
    if (!figure.picture.empty()) html += "<div class=\"film\">";
    html += "<video controls loop muted preload=\"none\" src=\"" + link_to(figure.video) + '"';
    if (!figure.picture.empty()) html += " poster=\"" + link_to(figure.picture) + '"';
    html += " aria-label=\"" + alt + "\"></video>";
    // on paper a video is its picture
    if (!figure.picture.empty())
      html += "<img class=\"in-print\" src=\"" + link_to(figure.picture) + "\" alt=\"" + alt +
              "\"></div>";
  } else if (!figure.picture.empty()) {
    html += "<img src=\"" + link_to(figure.picture) + "\" alt=\"" + alt + "\">";
  }
  if (!figure.caption.empty())
    html += "<figcaption>" + linked({figure.caption, figure.link}) + "</figcaption>";
  return html + "</figure>\n";
}

// A picture that leads to a page.
std::string thumbnail_html(const Figure& figure) {
  std::string picture = "<img loading=\"lazy\" src=\"" + link_to(figure.picture) + "\" alt=\"\">";
  if (!figure.link.empty())
    picture = "<a tabindex=\"-1\" aria-hidden=\"true\" href=\"" + html_escape(figure.link) + "\">" +
              picture + "</a>";
  return "<figure>" + picture + "<figcaption>" + linked({figure.caption, figure.link}) +
         "</figcaption></figure>\n";
}

}  // namespace

Page::Page(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void Page::heading(std::string_view text, int level, std::string_view id) {
  require(level >= 2 && level <= 4, "report: a heading's level is 2, 3 or 4");
  const std::string tag = "h" + std::to_string(level);
  body_ += '<' + tag + (id.empty() ? "" : " id=\"" + html_escape(id) + '"') + '>' +
           html_heading(text) + "</" + tag + ">\n";
}

void Page::paragraph(std::string_view text, Look look) {
  body_ += "<p" + class_attribute(look) + '>' + html_sentence(text) + "</p>\n";
}

void Page::links(const std::vector<Cell>& links) {
  body_ += "<nav>";
  for (const Cell& link : links) body_ += linked(link) + ' ';
  body_ += "</nav>\n";
}

void Page::list(const std::vector<Cell>& items) {
  body_ += "<ul>";
  for (const Cell& item : items) body_ += "<li>" + linked(item) + "</li>";
  body_ += "</ul>\n";
}

void Page::preformatted(std::string_view text) {
  body_ += "<pre>" + html_escape(text) + "</pre>\n";
}

void Page::code(std::string_view text) {
  body_ += "<pre class=\"code\" tabindex=\"0\">" + html_escape(text) + "</pre>\n";
}

void Page::preformatted(std::string_view text, const std::vector<Cell>& links) {
  body_ += "<pre>" + linked_within(text, links) + "</pre>\n";
}

void Page::fields(const std::vector<Field>& fields) {
  body_ += "<dl class=\"fields\">";
  for (const Field& field : fields)
    body_ += "<dt>" + html_escape(field.name) + "</dt><dd>" +
             linked_within(field.text, field.links) + "</dd>\n";
  body_ += "</dl>\n";
}

void Page::begin(Part part, std::string_view summary, std::string_view id) {
  const std::string name = id.empty() ? "" : " id=\"" + html_escape(id) + '"';
  switch (part) {
    case Part::kBox: body_ += "<section class=\"box\"" + name + ">\n"; break;
    case Part::kCard: body_ += "<article class=\"card\"" + name + ">\n"; break;
    case Part::kStory: body_ += "<div class=\"story\"" + name + ">\n"; break;
    case Part::kFold:
      body_ += "<details" + name + "><summary>" + html_escape(summary) + "</summary>\n";
  }
  open_.push_back(part == Part::kBox     ? "section"
                  : part == Part::kCard  ? "article"
                  : part == Part::kStory ? "div"
                                         : "details");
}

void Page::end() {
  require(!open_.empty(), "report: a part ends that was not begun");
  body_ += std::string("</") + open_.back() + ">\n";
  open_.pop_back();
}

void Page::fold(std::string_view summary, std::string_view text, bool open) {
  body_ += std::string("<details") + (open ? " open" : "") + "><summary>" + html_escape(summary) +
           "</summary><pre>" + html_escape(text) + "</pre></details>\n";
}

void Page::table(const Table& table) {
  const bool is_blocks = becomes_blocks(table);
  std::string classes = table.columns.size() > kManyColumns ? "many" : "";
  if (is_blocks) classes += classes.empty() ? "blocks" : " blocks";
  body_ += "<div class=\"wide\" tabindex=\"0\"><table" +
           (classes.empty() ? "" : " class=\"" + classes + '"') + '>';
  if (!table.caption.empty())
    body_ += "<caption><span>" + html_sentence(table.caption) + "</span></caption>";
  const bool has_head = std::any_of(table.columns.begin(), table.columns.end(),
                                    [](const Column& column) { return !column.name.empty(); });
  if (has_head) body_ += "<thead><tr>";
  for (std::size_t i = 0; has_head && i < table.columns.size(); ++i)
    body_ += "<th scope=\"col\"" + class_attribute(Look::kPlain, table.columns[i].is_number) + '>' +
             html_escape(table.columns[i].name) + "</th>";
  body_ += has_head ? "</tr></thead>\n<tbody>\n" : "<tbody>\n";
  for (const auto& row : table.rows) {
    require(row.size() == table.columns.size(),
            "report: a table's row must have one cell for each column");
    const std::string id = row.empty() ? "" : row.front().id;
    body_ += id.empty() ? "<tr>" : "<tr id=\"" + html_escape(id) + "\">";
    for (std::size_t i = 0; i < row.size(); ++i)
      body_ += "<td" + name_for_blocks(table.columns[i].name, is_blocks) +
               class_attribute(row[i].look, table.columns[i].is_number) + '>' + linked(row[i]) +
               "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::figures(const std::vector<Figure>& figures) {
  body_ += "<div class=\"figures\">\n";
  for (const Figure& figure : figures) body_ += figure_html(figure);
  body_ += "</div>\n";
}

void Page::thumbnails(const std::vector<Figure>& figures) {
  body_ += "<div class=\"figures thumbs\">\n";
  for (const Figure& figure : figures) body_ += thumbnail_html(figure);
  body_ += "</div>\n";
}

// Of a wide and a narrow drawing the one is shown that fits, so that letters can be read on a
// phone.
void Page::figure(const std::string& svg, const std::string& narrow, const std::string& caption) {
  body_ += narrow.empty() ? "<figure class=\"plot-figure small\">" + svg
                          : "<figure class=\"plot-figure both\">" + svg + narrow;
  if (!caption.empty()) body_ += "<figcaption>" + html_sentence(caption) + "</figcaption>";
  body_ += "</figure>\n";
}

void Page::plot(const Plot& plot) { figure(svg_of(plot), narrow_svg_of(plot), plot.caption); }
void Page::plot(const StackedBars& bars) {
  ++charts_of_bars_;
  figure(svg_of(bars, charts_of_bars_), bars.is_small ? "" : narrow_svg_of(bars, charts_of_bars_),
         bars.caption);
}
void Page::plot(const Arms& arms) { figure(svg_of(arms), "", arms.caption); }

void Page::tiles(const std::vector<std::pair<std::string, Cell>>& tiles) {
  body_ += "<div class=\"tiles\">";
  for (const auto& [name, value] : tiles)
    body_ += "<div class=\"tile\"><b" + class_attribute(value.look) + '>' + linked(value) +
             "</b><span>" + html_escape(name) + "</span></div>";
  body_ += "</div>\n";
}

void Page::program(const PageProgram& program) {
  require(script_.empty(), "report: a page has one program");
  require(program.script.find("</script") == std::string::npos,
          "report: a script must not hold the end of its element");
  body_ += "<div id=\"" + html_escape(program.id) + "\"><p class=\"muted\">" +
           html_escape(program.before) + "</p></div>\n";
  for (const PageData& data : program.data)
    body_ += "<script type=\"application/octet-stream\" id=\"" + html_escape(data.id) + "\">" +
             html_escape(data.base64) + "</script>\n";
  script_ = program.script;
  style_ = program.style;
}

void Page::record(std::string_view text) { record_ = html_escape(text); }

std::string Page::html() const {
  require(open_.empty(), "report: a part of the page has no end");
  const std::string title = html_escape(title_);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy_for(script_) + "\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
          title + "</title>\n<style>" + kStyle + plot_style() + style_ +
          "</style>\n</head>\n<body>\n<header><h1>" + title + "</h1>";
  html += (subtitle_.empty() ? "" : "<p>" + html_escape(subtitle_) + "</p>") +
          "</header>\n<main>\n" + body_ + "</main>\n";
  if (!record_.empty()) html += "<footer><p>" + record_ + "</p></footer>\n";
  if (!script_.empty()) html += "<script>" + script_ + "</script>\n";
  return html + "</body>\n</html>\n";
}

void Page::write(const std::filesystem::path& file) const { write_whole(file, html()); }

}  // namespace tumble::report
