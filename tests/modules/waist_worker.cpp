// Answers calls to a body of the test module, inside the sandbox.
#include "framework/grading/worker/worker_program.h"
#include "tests/modules/waist.h"

int main(int argc, char** argv) { return tumble::grading::run_worker<tumble::waist::Module>(argc, argv); }
