#include "framework/report/bench.h"

#include "framework/core/error.h"
#include "framework/core/zip.h"
#include "framework/report/bench_files.h"
#include "framework/report/channels.h"

namespace tumble::report {
namespace {

std::string joined(std::initializer_list<const char*> names) {
  std::string text = "'use strict';\n";
  for (const char* name : names) text += std::string(bench_file(name)) + "\n";
  return text;
}

std::string packed(const std::string& bytes) { return base64(deflated(bytes)); }

}  // namespace

void add_bench(Page& page, const Bench& bench) {
  require(!bench.own.empty(), "report: a bench needs a module");
  const std::string worker = joined({"host.js", "solid.js"}) + bench.experiments + "\n" +
                             std::string(bench_file("worker.js"));
  std::vector<PageData> data = {{"bench-worker", packed(worker)}, {"bench-own", packed(bench.own)}};
  if (!bench.right.empty()) data.push_back({"bench-right", packed(bench.right)});
  page.program({"bench",
                "This part needs scripts and WebAssembly; the pictures and numbers of the page "
                "need neither.",
                "(() => {\n" + joined({"solid.js", "bench.js", "stage.js"}) + "})();\n",
                std::string(bench_file("bench.css")), data});
}

}  // namespace tumble::report
