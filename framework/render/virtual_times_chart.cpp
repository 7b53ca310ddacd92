#include "framework/render/virtual_times_chart.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/render/text.h"

namespace tumble::render {
namespace {

// Pixels.
constexpr int kLeft = 110, kRight = 24, kRow = 26, kBar = 16, kHead = 40, kAxis = 44, kTitle = 40,
              kLegend = 30;
constexpr std::size_t kMostCharts = 6;  // where options.moves is empty

struct Colour {
  std::uint8_t red, green, blue;
};
// The colours of the page's chart; in print they differ in lightness.
constexpr Colour kCommitted{0, 68, 107}, kAhead{140, 190, 222}, kUndone{193, 77, 0},
    kGrid{217, 224, 230}, kLine{28, 39, 51};

void fill(Image& image, double x0, double y0, double x1, double y1, const Colour& colour) {
  const auto clamped = [](double v, int most) {
    return std::clamp(static_cast<int>(std::lround(v)), 0, most);
  };
  for (int y = clamped(y0, image.height); y < clamped(y1, image.height); ++y)
    for (int x = clamped(x0, image.width); x < clamped(x1, image.width); ++x) {
      std::uint8_t* pixel = image.pixel(x, y);
      pixel[0] = colour.red;
      pixel[1] = colour.green;
      pixel[2] = colour.blue;
    }
}

void hatch(Image& image, double x0, double y0, double x1, double y1) {
  for (int y = static_cast<int>(y0); y < static_cast<int>(y1); ++y)
    for (int x = static_cast<int>(x0); x < static_cast<int>(x1); ++x)
      if ((x + y) % 6 < 2) fill(image, x, y, x + 1, y + 1, kUndone);
}

// A round number that gives about four to eight ticks.
double tick_spacing(double range) {
  const double decade = std::pow(10.0, std::floor(std::log10(range / 4)));
  for (const double part : {1.0, 2.0, 5.0, 10.0})
    if (range / (part * decade) <= 8) return part * decade;
  return decade;
}

std::vector<std::size_t> moves_at_rollbacks(const VirtualTimes& times) {
  std::vector<std::size_t> moves;
  for (std::size_t k = 0; k < times.moves.size() && moves.size() < kMostCharts; ++k) {
    const auto is_back = [&](std::size_t i) {
      return i < times.moves.size() && !(times.moves[i].to_s > times.moves[i].from_s);
    };
    if (!is_back(k) && is_back(k + 1)) moves.push_back(k + 1);  // before a rollback
    if (is_back(k) && !is_back(k + 1)) moves.push_back(k + 1);  // after it
  }
  if (moves.empty()) moves.push_back(times.moves.size());
  return moves;
}

class Chart {
 public:
  Chart(const VirtualTimes& times, const ChartOptions& options)
      : times_(times),
        options_(options),
        moves_(options.moves.empty() ? moves_at_rollbacks(times) : options.moves) {
    low_ = options.from_s;
    high_ = options.to_s;
    if (!(high_ > low_))
      for (std::size_t k = 0; k < moves_.back(); ++k)
        high_ = std::max({high_, times.moves[k].to_s, times.moves[k].from_s});
    const int charts = static_cast<int>(moves_.size()),
              rows = static_cast<int>(times.processes.size());
    image_ = Image(options.width, kTitle + kLegend + charts * (kHead + rows * kRow) + kAxis);
  }

  Image draw() {
    writer_.write(image_, writer_.fitted(options_.title, 18, image_.width - 32, true), 16, 28, 18,
                  plain(kDark), Align::kLeft, true);
    legend(kTitle);
    double top = kTitle + kLegend;
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      draw_one(i, top);
      top += kHead + kRow * static_cast<double>(times_.processes.size());
    }
    axis(top);
    return image_;
  }

 private:
  static Ink plain(Ink ink) {
    ink.halo = 0.0;
    return ink;
  }
  double x(double t) const {
    return kLeft +
           std::clamp((t - low_) / (high_ - low_), 0.0, 1.0) * (image_.width - kLeft - kRight);
  }

  void legend(double top) {
    double at = kLeft;
    const auto entry = [&](const std::string& words, const auto& swatch) {
      swatch(at);
      writer_.write(image_, words, at + 30, top + 14, 13, plain(kDark));
      at += 30 + writer_.width(words, 13) + 26;
    };
    entry("committed",
          [&](double from) { fill(image_, from, top + 2, from + 24, top + 16, kCommitted); });
    entry("ahead of global virtual time",
          [&](double from) { fill(image_, from, top + 2, from + 24, top + 16, kAhead); });
    entry("undone by a rollback", [&](double from) {
      hatch(image_, from, top + 2, from + 24, top + 16);
      fill(image_, from, top, from + 3, top + 18, kUndone);
    });
    entry("GVT", [&](double from) { fill(image_, from + 11, top, from + 13, top + 18, kLine); });
  }

  void draw_one(std::size_t which, double top) {
    const std::size_t until = moves_[which], since = which > 0 ? moves_[which - 1] : until - 1;
    std::vector<double> local(times_.processes.size(), 0.0);
    double gvt = 0.0;
    for (std::size_t k = 0; k < until; ++k) {
      local[static_cast<std::size_t>(times_.moves[k].process)] = times_.moves[k].to_s;
      gvt = times_.moves[k].global_virtual_time_s;
    }
    writer_.write(image_, writer_.fitted(head(since, until, gvt), 13.5, image_.width - 24, true),
                  16, top + 24, 13.5, plain(kDark), Align::kLeft, true);
    const double bars = top + kHead, bottom = bars + kRow * static_cast<double>(local.size());
    for (const double t : ticks()) fill(image_, x(t), bars - 4, x(t) + 1, bottom, kGrid);
    for (std::size_t i = 0; i < local.size(); ++i) {
      const double y = bars + kRow * static_cast<double>(i);
      writer_.write(image_, writer_.fitted(times_.processes[i], 14, kLeft - 24), kLeft - 10, y + 13,
                    14, plain(kDark), Align::kRight);
      fill(image_, x(low_), y, x(local[i]), y + kBar, kAhead);
      fill(image_, x(low_), y, x(std::min(local[i], gvt)), y + kBar, kCommitted);
    }
    for (std::size_t k = since; k < until; ++k) {
      const VirtualTimes::Move& move = times_.moves[k];
      if (move.to_s > move.from_s) continue;
      const double y = bars + kRow * static_cast<double>(move.process);
      // Only where the process has not advanced again since.
      hatch(image_, x(std::max(move.to_s, local[static_cast<std::size_t>(move.process)])), y,
            x(move.from_s), y + kBar);
      fill(image_, x(move.to_s) - 1, y - 4, x(move.to_s) + 2, y + kBar + 4, kUndone);
    }
    fill(image_, x(gvt) - 1, bars - 6, x(gvt) + 1, bottom, kLine);
  }

  std::string head(std::size_t since, std::size_t until, double gvt) const {
    std::string back;
    for (std::size_t k = since; k < until; ++k) {
      const VirtualTimes::Move& move = times_.moves[k];
      if (move.to_s > move.from_s) continue;
      const std::string& name = times_.processes[static_cast<std::size_t>(move.process)];
      back += (back.empty() ? "" : ", ") +
              (move.to_s < move.from_s
                   ? fmt::format("{} back from {:.4g} to {:.4g} s", name, move.from_s, move.to_s)
                   : fmt::format("{} forgets {:.4g} s", name, move.to_s));
    }
    const std::string of_all =
        times_.is_cut ? fmt::format(" of the first {}", times_.moves.size()) : "";
    return fmt::format("After move {}{}, GVT {:.4g} s{}{}", until, of_all, gvt,
                       back.empty() ? "" : ": ", back);
  }

  std::vector<double> ticks() const {
    const double spacing = tick_spacing(high_ - low_);
    std::vector<double> ticks;
    for (long k = static_cast<long>(std::ceil(low_ / spacing - 1e-9));
         static_cast<double>(k) * spacing <= high_ + 1e-9 * spacing; ++k)
      ticks.push_back(static_cast<double>(k) * spacing);
    return ticks;
  }

  void axis(double top) {
    for (const double t : ticks())
      writer_.write(image_, fmt::format("{:.6g}", t), x(t), top + 14, 13, plain(kDark),
                    Align::kCentre);
    writer_.write(image_, "virtual time [s]", 0.5 * (kLeft + image_.width - kRight), top + 34, 13,
                  plain(kDark), Align::kCentre);
  }

  const VirtualTimes& times_;
  const ChartOptions& options_;
  std::vector<std::size_t> moves_;
  double low_ = 0.0, high_ = 0.0;
  Image image_;
  TextWriter writer_;
};

}  // namespace

void write_virtual_times_chart(const std::filesystem::path& png, const VirtualTimes& times,
                               const ChartOptions& options) {
  if (times.moves.empty())
    throw UserError(png.string(), "there is no move of a scheduler to draw",
                    "Run with --engine tw and a scheduler module: --modules a4=student.");
  for (const std::size_t move : options.moves)
    if (move < 1 || move > times.moves.size())
      throw UserError(fmt::format("move {}", move),
                      fmt::format("this run has moves 1 to {}{}", times.moves.size(),
                                  times.is_cut ? ", and more that are not recorded" : ""),
                      "Choose among these.");
  std::vector<std::size_t> sorted = options.moves;
  std::sort(sorted.begin(), sorted.end());
  ChartOptions in_order = options;
  in_order.moves = sorted;
  write_png(png, Chart(times, in_order).draw());
}

}  // namespace tumble::render
