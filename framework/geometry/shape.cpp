#include "framework/geometry/shape.h"
