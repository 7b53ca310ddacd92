#include "framework/engines/truths/families.h"

namespace tumble::truths {

const std::map<std::string, FrameworkFamily>& framework_families() {
  static const std::map<std::string, FrameworkFamily> families{
  };
  return families;
}

}  // namespace tumble::truths
