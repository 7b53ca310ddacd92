#include "framework/report/virtual_times_panel.h"

#include <nlohmann/json.hpp>

namespace tumble::report {

PlayerPanel virtual_times_panel(const VirtualTimes& times) {
  nlohmann::ordered_json moves = nlohmann::ordered_json::array();
  for (const VirtualTimes::Move& move : times.moves)
    moves.push_back({move.process, move.from_s, move.to_s, move.global_virtual_time_s});
  nlohmann::ordered_json data{{"processes", times.processes}, {"moves", std::move(moves)}};
  if (times.is_cut) data["is_cut"] = true;
  return {"virtual_times", "Virtual times",
          data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)};
}

}  // namespace tumble::report
