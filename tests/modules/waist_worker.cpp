// The sandboxed worker of the test module.
#include "framework/grading/worker/worker_program.h"
#include "tests/modules/waist.h"

int main(int argc, char** argv) {
  return tumble::grading::run_worker<tumble::waist::Module>(argc, argv);
}
