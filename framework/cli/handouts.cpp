// tumble handouts: every handout as a page and as a PDF, with figures drawn by the framework at
// build time.
#include <cstdlib>
#include <fstream>
#include <memory>
#include <regex>
#include <set>

#include <fmt/format.h>

#include "framework/cli/command.h"
#include "framework/cli/record.h"
#include "framework/cli/words.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"
#include "framework/report/html.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

struct HandoutsOptions {
  std::string out = "out/handouts";
  bool pdf = true;
};

struct Handout {
  fs::path file;  // handouts/NAME.md
  std::vector<std::string> lines;
  std::set<std::string> anchors;
  std::string title;
};

Handout read_handout(const fs::path& file) {
  static const std::regex anchor("<a id=\"([^\"]+)\">");
  Handout handout{file, {}, {}, file.stem().string()};
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    for (std::sregex_iterator it(line.begin(), line.end(), anchor), end; it != end; ++it)
      handout.anchors.insert((*it)[1]);
    if (handout.title == file.stem() && line.starts_with("# ")) handout.title = line.substr(2);
    handout.lines.push_back(line);
  }
  return handout;
}

std::vector<Handout> read_handouts(const fs::path& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".md") files.insert(entry.path());
  std::vector<Handout> handouts;
  for (const fs::path& file : files) handouts.push_back(read_handout(file));
  if (handouts.empty())
    throw UserError(folder.string(), "there is no handout here",
                    "A handout is a file handouts/NAME.md.");
  return handouts;
}

// The fault of a link; empty for a valid link.
std::string fault_of(const std::string& link, const Handout& from, const std::vector<Handout>& all,
                     const fs::path& figures) {
  static const std::regex scheme("[a-z]+:.*");
  if (std::regex_match(link, scheme)) return "";
  const std::size_t hash = link.find('#');
  const std::string path = link.substr(0, hash),
                    anchor = hash == link.npos ? "" : link.substr(hash + 1);
  const Handout* to = path.empty() ? &from : nullptr;
  for (const Handout& other : all)
    if (other.file.filename() == path) to = &other;
  if (to != nullptr)
    return anchor.empty() || to->anchors.contains(anchor)
               ? ""
               : fmt::format("{} has no place '{}'", to->file.filename().string(), anchor);
  const fs::path file =
      path.starts_with("figures/") ? figures / path.substr(8) : from.file.parent_path() / path;
  return fs::exists(file) ? ""
                          : fmt::format("there is no {}",
                                        path.starts_with("figures/")
                                            ? "figure " + path.substr(8) +
                                                  ", and handouts/make_figures.sh does not draw it"
                                            : "file " + path);
}

void check_links(const std::vector<Handout>& handouts, const fs::path& figures) {
  static const std::regex link("\\]\\(([^)\\s]+)\\)");
  std::string faults;
  for (const Handout& handout : handouts)
    for (std::size_t i = 0; i < handout.lines.size(); ++i)
      for (std::sregex_iterator it(handout.lines[i].begin(), handout.lines[i].end(), link), end;
           it != end; ++it)
        if (const std::string fault = fault_of((*it)[1], handout, handouts, figures);
            !fault.empty())
          faults += fmt::format("\n  {}:{}: ({}): {}", handout.file.filename().string(), i + 1,
                                std::string((*it)[1]), fault);
  if (!faults.empty())
    throw UserError("handouts", "links that lead nowhere:" + faults,
                    "Correct them, then run the command again.");
}

// What of a new handout its author has not written yet: the page shows it, too.
void say_unwritten(const std::vector<Handout>& handouts) {
  for (const Handout& handout : handouts)
    for (std::size_t i = 0; i < handout.lines.size(); ++i)
      if (handout.lines[i].find("(to be written") != std::string::npos)
        fmt::print(stderr, "handouts/{}:{}: {}\n", handout.file.filename().string(), i + 1,
                   handout.lines[i]);
}

// Draws the figures where the reference solutions are; a tree without them contains the pictures.
void make_figures(const Command& command, const fs::path& figures) {
  fs::remove_all(figures);  // an old picture would hide that it is not drawn any more
  fs::create_directories(figures);
  if (!fs::exists(command.root / "solutions_private")) {
    fs::copy(command.root / "handouts/figures", figures,
             fs::copy_options::overwrite_existing | fs::copy_options::recursive);
    fmt::print(stderr,
               "tumble: this tree has no reference solutions to draw figures with: those that came "
               "with it are used\n");
    return;
  }
  const auto made =
      run_program({"bash", (command.root / "handouts/make_figures.sh").string(), figures.string()},
                  Output::kCaptured);
  if (made.code != 0)
    throw UserError("handouts/make_figures.sh",
                    "did not draw the figures; it said:\n" + made.printed,
                    "Correct what it names, then run the command again.");
}

void run_pandoc(const Command& command, const Handout& handout, const fs::path& out,
                const std::vector<std::string>& more) {
  const fs::path folder = command.root / "handouts";
  // Pictures are taken from the folder where they were just drawn, not from beside the handout. A
  // warning of pandoc (a missing picture, a formula that it cannot read) is an error.
  std::vector<std::string> words = {"pandoc",
                                    handout.file.string(),
                                    "--from=markdown",
                                    "--standalone",
                                    "--fail-if-warnings",
                                    "--lua-filter=" + (folder / "pages.lua").string(),
                                    "--resource-path=" + out.string(),
                                    "--metadata=root:" + fs::relative(folder, out).string() + "/",
                                    "--metadata=lang:en"};
  words.insert(words.end(), more.begin(), more.end());
  const auto done = run_program(words, Output::kCaptured, 300);
  if (done.code == 127)
    throw UserError("pandoc", "is not installed", "Install what packages.txt lists.");
  if (done.code != 0)
    throw UserError(handout.file.string(), "could not be built; pandoc said:\n" + done.printed,
                    "Correct what it names.");
}

void write_index(const Command& command, const std::vector<Handout>& handouts,
                 const HandoutsOptions& options, const fs::path& out) {
  report::Page page("Handouts", "as pages and for paper");
  report::Table table;
  table.columns = {{"Handout"}, {"For paper"}};
  for (const Handout& handout : handouts) {
    const std::string name = handout.file.stem().string();
    table.rows.push_back(
        {{handout.title, report::link_to(name + ".html")},
         options.pdf ? report::Cell{"PDF", report::link_to(name + ".pdf")} : report::Cell{""}});
  }
  page.table(table);
  page.record(record_of(command));
  page.write(out / "index.html");
}

void build_handouts(Command& command, const HandoutsOptions& options) {
  const fs::path out = fs::absolute(options.out), figures = out / "figures",
                 folder = command.root / "handouts";
  if (fs::weakly_canonical(out) == fs::weakly_canonical(folder))
    throw UserError("--out " + options.out, "is where the handouts themselves stand",
                    "Name another folder, for example out/handouts.");
  const std::vector<Handout> handouts = read_handouts(folder);
  say_unwritten(handouts);
  make_figures(command, figures);
  check_links(handouts, figures);
  // no date in a PDF: the same handout gives the same bytes
  ::setenv("SOURCE_DATE_EPOCH", "0", 1);
  ::setenv("FORCE_SOURCE_DATE", "1", 1);
  for (const Handout& handout : handouts) {
    const std::string name = (out / handout.file.stem()).string();
    run_pandoc(command, handout, out,
               {"--to=html5", "--mathml", "--self-contained", "--toc", "--toc-depth=2",
                "--css=" + (folder / "handout.css").string(), "--output=" + name + ".html"});
    if (options.pdf)
      run_pandoc(
          command, handout, out,
          {"--pdf-engine=pdflatex", "--include-in-header=" + (folder / "paper.tex").string(),
           "--variable=papersize:a4", "--variable=geometry:margin=24mm", "--variable=fontsize:10pt",
           "--variable=colorlinks:true", "--output=" + name + ".pdf"});
    fmt::print("{}.html{}\n", name, options.pdf ? "  " + name + ".pdf" : "");
  }
  write_index(command, handouts, options, out);
}

}  // namespace

void add_handouts(CLI::App& app, Command& command) {
  auto options = std::make_shared<HandoutsOptions>();
  Verb verb(app, "handouts", "Build every handout as a page and as a PDF, with figures drawn now");
  verb.option("--out", options->out, "Folder of the pages").shows_default();
  verb.flag("!--no-pdf", options->pdf, "Pages only");
  verb.runs([&command, options] { build_handouts(command, *options); });
}

}  // namespace tumble::cli
