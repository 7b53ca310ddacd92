/// A page in a real browser: its elements and its picture. Chromium is not a package of the
/// project: without it, tests that need it are skipped and say so.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <png.h>

#include "framework/core/files.h"

namespace tumble::testing {

struct Screen {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  const std::uint8_t* at(int x, int y) const {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x))];
  }
};

class Browser {
 public:
  static bool is_installed() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

  /// Writes the page, with a script of the test at its end. @return its address
  std::string serve(std::string page, const std::string& script = "") {
    if (!script.empty()) page.insert(page.rfind("</body>"), "<script>" + script + "</script>");
    const std::filesystem::path file = folder_.path() / "page.html";
    write_whole(file, page);
    return "file://" + file.string();
  }

  /// The page's elements after its scripts have run for a while.
  std::string elements(const std::string& address, const std::string& flags = "") {
    const std::filesystem::path out = folder_.path() / "dom.html";
    run(flags + " --dump-dom '" + address + "' >" + out.string());
    std::ifstream in(out);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  Screen screenshot(const std::string& address, int width, int height) {
    const std::filesystem::path out = folder_.path() / "screen.png";
    run("--window-size=" + std::to_string(width) + "," + std::to_string(height) +
        " --screenshot=" + out.string() + " '" + address + "'");
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&image, out.c_str()))
      throw std::runtime_error("the browser wrote no picture");
    image.format = PNG_FORMAT_RGB;
    Screen screen{static_cast<int>(image.width), static_cast<int>(image.height),
                  std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
    png_image_finish_read(&image, nullptr, screen.rgb.data(), 0, nullptr);
    return screen;
  }

 private:
  // --virtual-time-budget: the page's clock advances 4 s, as fast as its work allows. WebGL is
  // rendered in software.
  void run(const std::string& what) {
    const std::string command =
        "timeout 100 chromium --headless --no-sandbox --disable-quic --no-first-run "
        "--disable-background-networking --disable-component-update --disable-sync "
        "--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars "
        "--virtual-time-budget=4000 --user-data-dir=" +
        (folder_.path() / "profile").string() + " " + what + " 2>/dev/null";
    if (std::system(command.c_str()) != 0) throw std::runtime_error("chromium failed: " + command);
  }

  PrivateFolder folder_;
};

/// Value of a data attribute of the body element, e.g. "ready"; empty where there is none.
inline std::string body_data(const std::string& elements, const std::string& name) {
  const std::size_t body = elements.find("<body"), end = elements.find('>', body),
                    at = elements.find("data-" + name + "=\"", body);
  if (at == std::string::npos || at > end) return "";
  const std::size_t from = at + name.size() + 7;
  return elements.substr(from, elements.find('"', from) - from);
}

}  // namespace tumble::testing
