// tumble plots PAGE: the plots of a page as pictures, for handouts, slides and papers.
#include <fstream>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "framework/cli/command.h"
#include "framework/cli/words.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"
#include "framework/report/plot_files.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

struct PlotsOptions {
  std::string page, out;
  int width_px = 1280;
  bool svg = false;
};

std::string read_page(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!fs::is_regular_file(file) || !(text << in.rdbuf()))
    throw UserError(
        file.string(), "cannot be read",
        "Name a page that tumble wrote, for example out/cost/double_pendulum/index.html.");
  return text.str();
}

void draw(const fs::path& svg, const fs::path& png, int width_px) {
  make_whole(png, [&](const fs::path& draft) {
    const auto done =
        run_program({"rsvg-convert", "--width=" + std::to_string(width_px), "--keep-aspect-ratio",
                     "--output=" + draft.string(), svg.string()},
                    Output::kCaptured, 60);
    if (done.code == 127)
      throw UserError("rsvg-convert", "is not installed",
                      "Install what packages.txt lists, or ask for --svg.");
    if (done.code != 0)
      throw UserError(png.string(), "could not be drawn; rsvg-convert said: " + done.printed,
                      "Ask for --svg, and look at the plot in a browser.");
  });
}

void write_plots(const PlotsOptions& options) {
  const std::vector<report::PlotDocument> plots = report::plots_in(read_page(options.page));
  if (plots.empty())
    throw UserError(options.page, "holds no plots",
                    "Pages with plots are those of cost, engines, battery and grade.");
  const fs::path out =
      options.out.empty() ? fs::path(options.page).parent_path() / "plots" : fs::path(options.out);
  const PrivateFolder drafts;
  for (const report::PlotDocument& plot : plots) {
    const fs::path file = out / (plot.name + (options.svg ? ".svg" : ".png"));
    const fs::path svg = options.svg ? file : drafts.path() / (plot.name + ".svg");
    write_whole(svg, plot.svg);
    if (!options.svg) draw(svg, file, options.width_px);
    fmt::print("{}\n", file.string());
  }
}

}  // namespace

void add_plots(CLI::App& app, Command&) {
  auto options = std::make_shared<PlotsOptions>();
  Verb verb(app, "plots", "The plots of a page as PNG or SVG, for handouts, slides and papers");
  verb.option("page", options->page,
              "A page with plots, as cost, engines, battery or grade wrote it")
      .required()
      .type_name("PAGE");
  verb.option("--out", options->out, "Folder of the pictures (default: plots beside the page)");
  verb.option("--width-px", options->width_px, "Width of a PNG").shows_default().between(64, 8192);
  verb.flag("--svg", options->svg, "SVG instead of PNG");
  verb.footer(
      "Example: tumble cost double_pendulum; tumble plots out/cost/double_pendulum/index.html");
  verb.runs([options] { write_plots(*options); });
}

}  // namespace tumble::cli
