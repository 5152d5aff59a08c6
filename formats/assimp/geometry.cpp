// Assimp's meshes and bones as glTF meshes and skins.
#include <array>
#include <cmath>

#include "formats/assimp/import.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxJoints = 0xffff;
constexpr std::size_t kMaxInfluenceSets = 64;

bool is_finite(const aiVector3D& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::vector<float> numbers_of(const aiVector3D* vectors, std::size_t count) {
  std::vector<float> numbers;
  numbers.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const aiVector3D v = is_finite(vectors[i]) ? vectors[i] : aiVector3D();
    numbers.insert(numbers.end(), {v.x, v.y, v.z});
  }
  return numbers;
}

struct Influence {
  std::uint16_t joint = 0;
  float weight = 0;
};

}  // namespace

/// Joints of all meshes that a node shows: a node and where vertices stand relative to it.
struct GeometryImport::Skin {
  std::map<std::pair<std::size_t, std::array<float, 16>>, std::uint16_t> numbers;
  std::vector<std::size_t> nodes;
  std::vector<float> inverse_bind_matrices;
};

std::vector<unsigned> GeometryImport::shown_meshes(const aiNode& node) {
  std::vector<unsigned> shown;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const unsigned number = node.mMeshes[i];
    if (number >= import_.scene.mNumMeshes || import_.scene.mMeshes[number] == nullptr)
      import_.fail("node " + quoted_name(node.mName) + " shows mesh " + std::to_string(number) +
                   ", which there is none of");
    const aiMesh& mesh = *import_.scene.mMeshes[number];
    bool has_triangles = false;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      if (mesh.mFaces[f].mNumIndices == 3)
        has_triangles = true;
      else
        import_.note("points and lines are left out");
    }
    if (has_triangles && mesh.mVertices != nullptr && mesh.mNumVertices > 0)
      shown.push_back(number);
  }
  return shown;
}

std::size_t GeometryImport::target_count(const aiNode& node) const {
  std::size_t most = 0;
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    if (const unsigned number = node.mMeshes[i]; number < import_.scene.mNumMeshes)
      most = std::max<std::size_t>(most, import_.scene.mMeshes[number]->mNumAnimMeshes);
  return most;
}

ShownMesh GeometryImport::add(const aiNode& node) {
  const std::vector<unsigned> meshes = shown_meshes(node);
  if (meshes.empty()) return {};
  const auto [known, is_new] = shown_.try_emplace(meshes);
  if (!is_new) return known->second;

  const std::size_t targets = target_count(node);
  Skin skin;
  Json primitives = Json::array();
  std::vector<double> weights(targets, 0.0);
  for (const unsigned number : meshes) {
    const aiMesh& mesh = *import_.scene.mMeshes[number];
    primitives.push_back(primitive(mesh, targets, skin));
    for (unsigned t = 0; t < mesh.mNumAnimMeshes; ++t)
      if (const float w = mesh.mAnimMeshes[t]->mWeight; std::isfinite(w)) weights[t] = w;
  }
  Json mesh = {{"primitives", std::move(primitives)}};
  if (targets > 0) mesh["weights"] = weights;
  known->second.mesh = import_.glb.add("meshes", std::move(mesh));
  if (!skin.nodes.empty())
    known->second.skin = import_.glb.add(
        "skins",
        {{"joints", skin.nodes},
         {"inverseBindMatrices", import_.glb.add_floats("MAT4", skin.inverse_bind_matrices)}});
  return known->second;
}

Json GeometryImport::primitive(const aiMesh& mesh, std::size_t targets, Skin& skin) {
  const std::size_t count = mesh.mNumVertices;
  const std::string place = "mesh " + quoted_name(mesh.mName);
  for (std::size_t i = 0; i < count; ++i)
    if (!is_finite(mesh.mVertices[i]))
      import_.fail(place + ": vertex " + std::to_string(i) +
                   " has a coordinate that is not a finite number");
  std::vector<std::uint32_t> corners;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    if (mesh.mFaces[f].mNumIndices != 3) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const unsigned vertex = mesh.mFaces[f].mIndices[c];
      if (vertex >= count)
        import_.fail(place + " has a corner at vertex " + std::to_string(vertex) + " of " +
                     std::to_string(count));
      corners.push_back(vertex);
    }
  }
  GlbBuilder& glb = import_.glb;
  Json attributes = {{"POSITION", glb.add_floats("VEC3", numbers_of(mesh.mVertices, count))}};
  if (mesh.mNormals != nullptr)
    attributes["NORMAL"] = glb.add_floats("VEC3", numbers_of(mesh.mNormals, count));
  for (unsigned set = 0; set < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++set) {
    if (mesh.mTextureCoords[set] == nullptr) break;
    std::vector<float> uv;
    for (std::size_t i = 0; i < count; ++i) {
      const aiVector3D& t = mesh.mTextureCoords[set][i];
      const bool usable = std::isfinite(t.x) && std::isfinite(t.y);
      uv.insert(uv.end(), {usable ? t.x : 0, usable ? 1 - t.y : 0});  // v runs upwards there
    }
    attributes["TEXCOORD_" + std::to_string(set)] = glb.add_floats("VEC2", uv);
  }
  if (mesh.mColors[0] != nullptr) {
    std::vector<float> colors;
    for (std::size_t i = 0; i < count; ++i)
      for (unsigned c = 0; c < 4; ++c) {
        const float channel = mesh.mColors[0][i][c];
        colors.push_back(std::isfinite(channel) ? channel : 1);
      }
    attributes["COLOR_0"] = glb.add_floats("VEC4", colors);
  }
  if (mesh.mNumBones > 0) add_bones(mesh, skin, attributes);
  Json out = {{"attributes", std::move(attributes)},
              {"indices", glb.add_indices(corners)},
              {"material", mesh.mMaterialIndex}};
  for (std::size_t t = 0; t < targets; ++t) out["targets"].push_back(target(mesh, t));
  return out;
}

/// Assimp has whole vertices where glTF has differences. Empty where the mesh has no such target.
Json GeometryImport::target(const aiMesh& mesh, std::size_t number) {
  if (number >= mesh.mNumAnimMeshes) return Json::object();
  const aiAnimMesh& target = *mesh.mAnimMeshes[number];
  if (target.mVertices == nullptr) return Json::object();
  if (target.mNumVertices != mesh.mNumVertices)
    import_.fail("mesh " + quoted_name(mesh.mName) + ": morph target " + std::to_string(number) +
                 " has other vertices than the mesh");
  std::vector<float> offsets;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D d = target.mVertices[i] - mesh.mVertices[i];
    if (!is_finite(d))
      import_.fail("mesh " + quoted_name(mesh.mName) + ": morph target " + std::to_string(number) +
                   " has a coordinate that is not a finite number");
    offsets.insert(offsets.end(), {d.x, d.y, d.z});
  }
  return {{"POSITION", import_.glb.add_floats("VEC3", offsets)}};
}

void GeometryImport::add_bones(const aiMesh& mesh, Skin& skin, Json& attributes) {
  const std::string place = "mesh " + quoted_name(mesh.mName);
  std::vector<std::vector<Influence>> influences(mesh.mNumVertices);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const auto node = import_.node_numbers.find(bone.mName.C_Str());
    if (node == import_.node_numbers.end())
      import_.fail(place + " hangs on the bone " + quoted_name(bone.mName) +
                   ", which there is no node for");
    const std::array<float, 16> columns = columns_of(bone.mOffsetMatrix);
    if (skin.nodes.size() == kMaxJoints) import_.fail(place + " hangs on over 65,534 bones");
    const auto next = static_cast<std::uint16_t>(skin.nodes.size());
    const auto [joint, is_new] = skin.numbers.try_emplace({node->second, columns}, next);
    if (is_new) {
      skin.nodes.push_back(node->second);
      skin.inverse_bind_matrices.insert(skin.inverse_bind_matrices.end(), columns.begin(),
                                        columns.end());
    }
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      const aiVertexWeight& weight = bone.mWeights[w];
      if (weight.mVertexId >= mesh.mNumVertices)
        import_.fail(place + ": the bone " + quoted_name(bone.mName) + " moves vertex " +
                     std::to_string(weight.mVertexId) + " of " + std::to_string(mesh.mNumVertices));
      if (!std::isfinite(weight.mWeight))
        import_.fail(place + ": the bone " + quoted_name(bone.mName) +
                     " has a weight that is not a finite number");
      if (weight.mWeight > 0)
        influences[weight.mVertexId].push_back({joint->second, weight.mWeight});
    }
  }
  std::size_t most = 1;
  for (const auto& list : influences) most = std::max(most, list.size());
  const std::size_t sets = (most + 3) / 4;
  if (sets > kMaxInfluenceSets)
    import_.fail(place + " has a vertex that hangs on over 256 bones; export it with fewer");
  for (std::size_t set = 0; set < sets; ++set) {
    std::vector<std::uint16_t> joints(4 * influences.size());
    std::vector<float> weights(4 * influences.size());
    for (std::size_t i = 0; i < influences.size(); ++i)
      for (std::size_t k = 4 * set; k < std::min(4 * set + 4, influences[i].size()); ++k) {
        joints[4 * i + k % 4] = influences[i][k].joint;
        weights[4 * i + k % 4] = influences[i][k].weight;
      }
    attributes["JOINTS_" + std::to_string(set)] = import_.glb.add_joints(joints);
    attributes["WEIGHTS_" + std::to_string(set)] = import_.glb.add_floats("VEC4", weights);
  }
}

}  // namespace mdk
