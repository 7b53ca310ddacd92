#include "framework/scene/scene.h"
