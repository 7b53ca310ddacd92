#include "tests/support/places.h"

namespace tumble::test {

std::string source_dir() { return TUMBLE_SOURCE_DIR; }
std::string binary_dir() { return TUMBLE_BINARY_DIR; }

}  // namespace tumble::test
