// Assimp's materials as glTF materials: base colour and one image.
#pragma once

#include "formats/assimp/scene_import.h"

namespace mdk {

/// One glTF material for each of the scene's. Colours of formats that do not say otherwise are
/// taken as sRGB. An image has to be in the input or, by its name at least, in its folder;
/// otherwise a note says so.
void add_materials(SceneImport& import);

}  // namespace mdk
