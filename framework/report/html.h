/// Pages for a browser or print, with one style and one place where text becomes HTML.
///
///   Page page("Assignment a1", "submission alice");
///   page.heading("Score");
///   page.table({.columns = {{"Test"}, {"Points", true}}, .rows = {{{"impulse"}, {.text = "3",
///   .look = Look::kGood}}}}); page.figures({{.picture = "run.png", .video = "run.mp4", .caption =
///   "A poked box"}}); page.write("out/index.html");
///
/// Everything that comes from a submission is text to these functions: it is escaped here and
/// nowhere else, and the page forbids scripts and network access, so that a story cannot attack its
/// reader. A page with a program lets this one script run, by its digest, and no other.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/report/arms.h"
#include "framework/report/html_text.h"
#include "framework/report/plot.h"
#include "framework/report/stacked_bars.h"

namespace tumble::report {

/// The meaning of a text, shown by colour and by weight, so that it is visible in print and to
/// colour-blind readers.
enum class Look { kPlain, kMuted, kGood, kWarning, kBad };

struct Cell {
  std::string text;
  std::string link = {};  // result of link_to, or "#id"; empty: none
  Look look = Look::kPlain;
  std::string id = {};  // in a table: anchor of its row, where its first cell has one
};

struct Column {
  std::string name;
  bool is_number = false;  // right-aligned
};

struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

/// A picture, a video, or a video with the picture as its poster. Paths are relative to the page.
struct Figure {
  std::filesystem::path picture;
  std::filesystem::path video;
  std::string caption;
  std::string label;      // small heading above, e.g. "reference"
  std::string link = {};  // of the caption: result of link_to; empty: none
};

/// A named value, such as "found: 6 N s".
struct Field {
  std::string name, text;
  std::vector<Cell> links = {};  // where the text holds a cell's text, it leads where the cell does
};

/// Bytes for a page's script, in base64.
struct PageData {
  std::string id;  // of the element that holds them
  std::string base64;
};

/// A part that a script fills: of this program, never of a submission.
struct PageProgram {
  std::string id;      // of the element that the script fills
  std::string before;  // what stands there without scripts
  std::string script;  // without "</script"
  std::string style;
  std::vector<PageData> data;
};

/// A part of a page that holds other parts.
enum class Part {
  kBox,    // with a border: what to read first
  kCard,   // one of several in a box
  kFold,   // opens on a click, and is open in print
  kStory,  // what happened in one test: fields, terms of an equation, a drawing
};

/// One page, written top to bottom. Every `text` is escaped.
class Page {
 public:
  /// @param subtitle  second line of the head; may be empty
  explicit Page(std::string title, std::string subtitle = "");

  /// @param level  2 (section), 3, or 4
  /// @param id     anchor for links "#id": letters, digits, - and _ only; may be empty
  void heading(std::string_view text, int level = 2, std::string_view id = "");
  void paragraph(std::string_view text, Look look = Look::kPlain);
  /// A line of links: {{text, link}, ...}
  void links(const std::vector<Cell>& links);
  /// A list, one item a line.
  void list(const std::vector<Cell>& items);
  /// Preformatted text in a fixed-width font: stories, commands, compiler output.
  void preformatted(std::string_view text);
  /// Lines of a program: one that is too long is read by scrolling, so that indents stay.
  void code(std::string_view text);
  /// Preformatted, with links: where the text holds a cell's text, it leads where the cell does.
  void preformatted(std::string_view text, const std::vector<Cell>& links);
  /// Named values, one below the other: the names at the left.
  void fields(const std::vector<Field>& fields);
  /// Begins a part, which holds what follows until its end.
  /// @param summary  the line of a fold; empty for others
  void begin(Part part, std::string_view summary = "", std::string_view id = "");
  void end();
  /// A section that opens on a click and is open in print: one line, then preformatted text.
  void fold(std::string_view summary, std::string_view text, bool open = false);
  /// Without a head where no column has a name.
  void table(const Table& table);
  /// Side by side while the page is wide enough.
  void figures(const std::vector<Figure>& figures);
  /// Small, as many in a row as fit: a table of contents in pictures. A click on a picture leads
  /// where its caption does; videos are not shown.
  void thumbnails(const std::vector<Figure>& figures);
  /// Draws it in the page, with its caption.
  void plot(const Plot& plot);
  void plot(const StackedBars& bars);
  void plot(const Arms& arms);
  /// Large numbers with names: scores at the head of a page.
  void tiles(const std::vector<std::pair<std::string, Cell>>& tiles);
  /// A part that a script fills. It may compile WebAssembly and start workers of its own text; it
  /// reaches no network.
  /// @pre  the page has no other
  void program(const PageProgram& program);
  /// Last line of the page: command, version, hash.
  void record(std::string_view text);

  /// The whole page.
  /// @pre  every part has its end
  std::string html() const;
  /// Writes the file whole or not at all. Creates missing folders.
  /// @throws UserError when the file cannot be written
  void write(const std::filesystem::path& file) const;

 private:
  void figure(const std::string& svg, const std::string& narrow, const std::string& caption);

  std::string title_, subtitle_, body_, record_, script_, style_;
  std::vector<const char*> open_;  // tags of parts without their end
  int charts_of_bars_ = 0;
};

}  // namespace tumble::report
