/// The schema of scene files, carried inside the program: the text of scene.schema.json at the time of the build.
#pragma once

namespace tumble::scene {
extern const char* const kSceneSchema;
}
