/// The schema of scene files inside the program: the text of scene.schema.json at build time.
#pragma once

namespace tumble::scene {
extern const char* const kSceneSchema;
}
