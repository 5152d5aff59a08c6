// A scene as Assimp has read it, as the glTF that this project's own reader takes.
#pragma once

#include <assimp/scene.h>

#include <string>
#include <vector>

namespace mdk {

struct SceneGlb {
  std::vector<unsigned char> bytes;
  std::vector<std::string> notes;  ///< one sentence per thing left out
};

/// Nodes, meshes, skins, morph targets, animations, base colours and images. +y up as Assimp turns
/// it, in metres where the file says its unit (FBX). Throws Error: kBadInput for what does not fit
/// together, kOverLimit.
SceneGlb encode_scene(const aiScene& scene, const std::string& path);

}  // namespace mdk
