/// One sitting at the page: the process that simulates, what was changed and pushed, the run so
/// far, the run before it, verdicts. Everything happens in one thread, the one that calls serve().
#pragma once

#include <functional>
#include <string>

#include "framework/live/sitting.h"

namespace tumble::live {

/// Serves until Ctrl-C, SIGTERM or the end of the terminal.
/// @param ready  called with the address of the page
/// @throws UserError where the port is taken, or a folder cannot be watched
Left serve(const Sitting& sitting, const std::function<void(const std::string& address)>& ready);

}  // namespace tumble::live
