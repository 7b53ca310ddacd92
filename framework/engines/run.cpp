#include "framework/trajectory/trajectory.h"
