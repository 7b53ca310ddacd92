// draw_handouts FOLDER: writes every drawing of the handouts as FOLDER/NAME.svg. The same tree
// gives the same bytes.
#include <cstdio>
#include <fstream>
#include <string>

#include "handouts/drawings/drawing.h"

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "Usage: draw_handouts FOLDER\n");
    return 2;
  }
  using namespace tumble::handouts;
  for (const std::vector<Figure>& figures : all_figures())
    for (const Figure& figure : figures) {
      const std::string file = std::string(words[1]) + "/" + figure.name + ".svg";
      if (!(std::ofstream(file) << figure.draw().svg())) {
        std::fprintf(stderr, "%s: cannot be written\n", file.c_str());
        return 2;
      }
    }
  return 0;
}
